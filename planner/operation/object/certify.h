// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/operation/table/object.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {

/// The reason, for people, why an object that only the mesh kernel computes has no certificate.
inline constexpr const char* mesh_alone =
    "no certificate: only the mesh kernel computes this object, and its voxels are digitised from that mesh";

/// Whether certify() can judge an object: it has a mesh within its universe, or a witness of its voxels.
inline bool has_certificate(const Object& made) {
  return made.mesh.within || made.witness;
}

/// Computes an object's certificate within the tolerances of its bound terms. For an object of both kernels,
/// compares their answers. For an object without a mesh, compares its voxels with their witness
/// (verify::certify_alone()). For a surface that only the mesh kernel changed, compares the mesh with the
/// specification of the step (verify::judge_reach()). Preconditions: the operation's bound() has run, and
/// has_certificate(). Throws Stopped.
void certify(Object& made, const std::string& title, const voxel::Progress& progress = {});

}  // namespace octotomy::planner
