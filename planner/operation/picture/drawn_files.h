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

/// The objects in the files. An octree of shares is drawn by the surface that partial volume gives it; with
/// Render::count by its voxels, as the thesis counts visits to them. All objects are in the first one's
/// universe and named as their files, without folder and ending. Throws std::runtime_error, with the path,
/// for files that cannot be drawn, and for invalid colours.
std::vector<voxel::DrawnObject> drawn_of_files(const Render& render, const std::vector<ObjectName>& files,
                                               const FileBench& bench);

/// A plan's object, with the samples that define its surface.
voxel::DrawnObject drawn(const Object& object, const glm::vec3& colour);

/// The files that a verb draws or names: those of its objects, then those that --let binds to the expression's
/// names, in the order of these. Throws std::runtime_error for names that are not bound or bound twice.
std::vector<ObjectName> files_of(const Render& render);

/// Replaces the last objects, which are operands, by their expression without building it. If exactly one
/// operand has samples, these define the surface, else the voxels' faces. Returns the objects as they are if
/// there is no expression. Throws std::runtime_error for an expression that cannot be read.
std::vector<voxel::DrawnObject> with_expression(const Render& render,
                                                std::vector<voxel::DrawnObject> objects);

/// Sets the requested colours and opacities, or the default ones.
void paint(const Render& render, std::vector<voxel::DrawnObject>& objects);

}  // namespace octotomy::planner
