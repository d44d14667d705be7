// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/operation/table/object.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {

/// The note on an object that only the mesh kernel makes.
inline constexpr const char* mesh_alone =
    "no certificate: only the mesh kernel computes this object, and its voxels are digitised from that mesh";

/// Whether certify() can judge an object: it has a mesh within its universe, or a witness for its voxels.
inline bool has_certificate(const Object& made) {
  return made.mesh.within || made.witness;
}

/// Certifies an object, within the tolerances of its bound terms. An object of both kernels: compares their
/// answers. An object without a mesh: compares the voxels with their witness (verify::certify_alone()). A
/// surface that only the mesh kernel changed: compares the mesh with the step's specification
/// (verify::judge_reach()). Preconditions: the operation's bound() has run, and has_certificate(). Throws
/// Stopped.
void certify(Object& made, const std::string& title, const voxel::Progress& progress = {});

}  // namespace octotomy::planner
