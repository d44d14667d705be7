// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The line "plausible_size", a Warn, if a scan's extent or the body in it does not have the size of a person
/// or an organ, with the spacing that would give a plausible size. None if the size is plausible, or if the
/// subject of the scan is unknown: label maps, and scans that are neither Hounsfield nor of a stated
/// modality. Evidence, in this order: a field wider than any scanner's; pixels coarser than any CT's; a field
/// of many pixels smaller than any organ; a body that is wholly surrounded by air and smaller than any head.
/// Precondition: the scene passes check().
std::optional<Finding> size_finding(const Scene& scene);

}  // namespace octotomy::voxel
