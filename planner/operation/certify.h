// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/table/object.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {

/// Told of an object that only the mesh kernel makes.
inline constexpr const char* mesh_alone =
    "no certificate: only the mesh kernel does this, and its voxels are its mesh's";

/// Holds both kernels' answers to one another, within what the object's bound terms allow. Preconditions: the
/// operation's bound() has run, and the object has a mesh within its universe. Throws Stopped.
void certify(Object& made, const std::string& title, const voxel::Progress& progress = {});

}  // namespace octotomy::planner
