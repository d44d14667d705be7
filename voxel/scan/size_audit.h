// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The line "plausible_size", a Warn, if a scan's extent or the body in it has no size of a person or an
/// organ, and what spacing would be right. None if the size is plausible, or if nothing shows whose scan it
/// is: label maps, and scans that are neither Hounsfield nor of a stated modality. Evidence, in this order: a
/// field wider than any scanner's; pixels coarser than any CT's; a field of many pixels smaller than any
/// organ; a whole body in the air, smaller than any head. Precondition: the scene passes check().
std::optional<Finding> size_finding(const Scene& scene);

}  // namespace octotomy::voxel
