// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>

#include "brep/boolean/boolean.h"
#include "brep/mesh/triangles.h"
#include "verify/certificate/certificate.h"
#include "verify/witness/witness.h"
#include "voxel/solid/expression.h"
#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

// A question for both kernels: (window of a scan - box) under a rigid motion, with both answers and their
// certificate. Faults and alterations change such answers.
namespace octotomy::verify {

/// The parameters of one kernel's answer. A fault changes them for one kernel only.
struct Making {
  double low = 0.0;           ///< lower bound of the window
  double slices_apart = 1.0;  ///< distance of the slices, as a multiple of the true one
  bool swapped = false;       ///< computes box - window instead of window - box
  glm::dvec3 box_shift_mm{0.0};
  bool pivot_forgotten = false;  ///< rotates about the origin instead of the pivot
  bool not_moved = false;        ///< leaves the motion out
};

struct Subject {
  std::string name;
  voxel::Scene scan;
  voxel::Universe universe;
  voxel::Box box;
  voxel::Motion motion;
  double low = 0.0;       ///< half way between outside and inside
  double contrast = 1.0;  ///< density inside minus density outside
};

/// The edge of the voxels of the subject's universe, in mm.
double edge_mm(const Subject& subject);

voxel::Octree voxel_answer(const Subject& subject, const Making& making);
brep::Triangles mesh_answer(const Subject& subject, const Making& making);
Witness witness_of(const Subject& subject, const Making& making);
/// Certifies two answers. `fault` names the fault that was injected, or is empty.
Certificate certified(const Subject& subject, const std::string& fault, const voxel::Octree& octree,
                      const brep::Triangles& triangles, const Witness& witness);

/// Returns the answer with a box added (Union) or removed (Difference).
voxel::Octree changed(const voxel::Octree& octree, const voxel::Box& box, brep::Operation operation);
brep::Triangles changed(const brep::Triangles& triangles, const voxel::Box& box, brep::Operation operation);
brep::Triangles shifted(brep::Triangles triangles, const glm::dvec3& by_mm);
/// Returns one list of the triangles and of those of a second surface.
brep::Triangles with_shell_again(brep::Triangles triangles, const brep::Triangles& again);

/// Returns the ellipsoid or the ring, by `name`: off centre, oblique and cut. They have no symmetry, because
/// a symmetry would hide a mirrored axis or swapped operands.
Subject shape_subject(const std::string& name, int voxels);
/// Returns the bone of the head phantom in a universe of `voxels` voxels a side.
Subject head_subject(int voxels);

}  // namespace octotomy::verify
