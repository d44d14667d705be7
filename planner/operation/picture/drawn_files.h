// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/picture/render.h"
#include "planner/operation/table/object.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::planner {

/// The objects of the files, all in the first one's universe, named after their files without folder and
/// extension. Throws std::runtime_error for files that cannot be drawn, with the path, and for texts that are
/// not colours.
std::vector<voxel::DrawnObject> drawn_of_files(const Render& render, const std::vector<ObjectName>& files,
                                               const FileBench& bench);

/// A plan's object, with the samples that define its surface.
voxel::DrawnObject drawn(const Object& object, const glm::vec3& colour);

/// Sets the requested colours and opacities, or the default ones.
void paint(const Render& render, std::vector<voxel::DrawnObject>& objects);

}  // namespace octotomy::planner
