// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Checks the slices of a stack, in the order of the files, against their neighbours:
/// - mirrored_slices, a Fail: slices that agree with their neighbours clearly better when they are mirrored
///   or turned;
/// - unlike_slices, a Fail: slices that agree with no neighbour, while the neighbours agree with each other;
/// - rows_columns, a Fail: images whose rows agree with each other at least twice as well if Rows and Columns
///   are exchanged.
/// Agreement is the correlation of images reduced to at most 64 x 64 pixels. Adds no line if there is no
/// doubt. Values below `floor` are raised to `floor`, so that padding does not outweigh the patient. `names`
/// are the slices' names for messages. Parallel over slices; same result on any thread count.
void audit_neighbours(const decltype(Scene::samples)& samples, const glm::ivec2& size_px,
                      const std::vector<std::string>& names, double floor, std::vector<Finding>& audit);

}  // namespace octotomy::voxel
