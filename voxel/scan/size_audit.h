// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Checks whether a scan's extent and the body in it can have the size of a person or an organ. If not,
/// returns the finding "plausible_size", a Warn, with the spacing that would result in a plausible size. None
/// if the size is plausible, or if the subject of the scan is unknown: label maps, and scans that are neither
/// Hounsfield nor of a stated modality. Evidence, in this order: a field wider than any scanner's; pixels
/// coarser than any CT's; a field of many pixels smaller than any organ; a body that is wholly surrounded by
/// air and smaller than any head. Precondition: the scene passes check().
std::optional<Finding> size_finding(const Scene& scene);

}  // namespace octotomy::voxel
