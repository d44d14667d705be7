// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "voxel/view/render.h"

// The results of `render` for a picture.
namespace octotomy::planner {

/// Nearest and farthest lit depth; null where nothing is lit.
Json depth_range_json(const voxel::Picture& picture);

/// What was drawn for each object, in the objects' order.
Json objects_json(const std::vector<voxel::DrawnObject>& objects, const voxel::Picture& picture);

/// The objects at pixels; null for the background. Precondition: pixels of the picture.
Json picks_json(const std::vector<glm::ivec2>& pixels, const std::vector<voxel::DrawnObject>& objects,
                const voxel::Picture& picture);

/// The distances to `other` on the visible surface of a picture's first object. Precondition: a scalar
/// colours it.
Json distances_json(const voxel::DrawnObject& object, const std::string& other,
                    const voxel::Picture& picture);

/// Adds the visits by level and status, and their sums.
void add_visits(Json& json, const voxel::Visits& visits);

}  // namespace octotomy::planner
