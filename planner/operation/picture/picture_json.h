// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "voxel/view/render.h"

// Parts of the JSON that `render` reports on a picture.
namespace octotomy::planner {

/// The nearest and the farthest lit depth; null if no pixel is lit.
Json depth_range_json(const voxel::Picture& picture);

/// For each object in order, the way in which it was drawn.
Json objects_json(const std::vector<voxel::DrawnObject>& objects, const voxel::Picture& picture);

/// The objects at the stated pixels; null for the background. Precondition: the pixels lie in the picture.
Json picks_json(const std::vector<glm::ivec2>& pixels, const std::vector<voxel::DrawnObject>& objects,
                const voxel::Picture& picture);

/// The distances to `other` on the visible surface of a picture's first object. Precondition: the object is
/// coloured by these distances.
Json distances_json(const voxel::DrawnObject& object, const std::string& other,
                    const voxel::Picture& picture);

/// Adds the visits for each level and status, and their sums.
void add_visits(Json& json, const voxel::Visits& visits);

}  // namespace octotomy::planner
