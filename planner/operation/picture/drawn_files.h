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

/// The objects in files. An octree of shares is drawn by its partial-volume surface; with Render::count by
/// its voxels, because the thesis counts visits to them. All objects have the universe of the first, and the
/// names of their files without folder and extension. Throws std::runtime_error that names the path if a file
/// cannot be drawn, and for invalid colours.
std::vector<voxel::DrawnObject> drawn_of_files(const Render& render, const std::vector<ObjectName>& files,
                                               const FileBench& bench);

/// An object of a plan, with the samples that define its surface.
voxel::DrawnObject drawn(const Object& object, const glm::vec3& colour);

/// The files that a verb draws or names: first those of its objects, then those of --let for the expression's
/// names, in the names' order. Throws std::runtime_error if a name has no file or several.
std::vector<ObjectName> files_of(const Render& render);

/// Replaces the last objects, which are the operands, by their expression, without evaluating it. If exactly
/// one operand has samples, these define the surface, otherwise the faces of the voxels. Without an
/// expression, returns the objects unchanged. Throws std::runtime_error for an invalid expression.
std::vector<voxel::DrawnObject> with_expression(const Render& render,
                                                std::vector<voxel::DrawnObject> objects);

/// Sets the colours and opacities of objects: the requested ones, or else the defaults.
void paint(const Render& render, std::vector<voxel::DrawnObject>& objects);

}  // namespace octotomy::planner
