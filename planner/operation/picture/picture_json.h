// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "voxel/view/render.h"

// What `render` says of a picture.
namespace octotomy::planner {

/// Nearest and farthest lit depth; null where nothing is lit.
Json depth_range_json(const voxel::Picture& picture);

/// What was drawn of every object, in their order.
Json objects_json(const std::vector<voxel::DrawnObject>& objects, const voxel::Picture& picture);

/// What pixels show; null where that is the background. Precondition: pixels of the picture.
Json picks_json(const std::vector<glm::ivec2>& pixels, const std::vector<voxel::DrawnObject>& objects,
                const voxel::Picture& picture);

/// The distances to `other` that are seen of a picture's first object. Precondition: a scalar colours it.
Json distances_json(const voxel::DrawnObject& object, const std::string& other,
                    const voxel::Picture& picture);

/// Visits by level and status, and what they come to.
void add_visits(Json& json, const voxel::Visits& visits);

}  // namespace octotomy::planner
