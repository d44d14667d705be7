// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "brep/boolean/boolean.h"
#include "brep/mesh/triangles.h"
#include "verify/certificate.h"
#include "verify/reading.h"
#include "voxel/solid/expression.h"
#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

// What errors are made in: a scan, and (window - box) under a rigid motion by both kernels.
namespace octotomy::verify {

/// The question as one kernel understands it.
struct Making {
  double low = 0.0;           ///< of the window
  double slices_apart = 1.0;  ///< times the true distance
  bool swapped = false;       ///< box less window
  glm::dvec3 box_shift_mm{0.0};
  bool pivot_forgotten = false;  ///< turned about the origin
  bool not_moved = false;        ///< as it was before the motion
};

struct Subject {
  std::string name;
  voxel::Scene scan;
  voxel::Universe universe;
  voxel::Box box;
  voxel::Motion motion;
  double low = 0.0;       ///< half way between outside and inside
  double contrast = 1.0;  ///< inside less outside
};

/// Edge of the universe's voxels.
double edge_mm(const Subject& subject);

voxel::Octree voxel_answer(const Subject& subject, const Making& making);
brep::Triangles mesh_answer(const Subject& subject, const Making& making);
Witness witness_of(const Subject& subject, const Making& making);
/// The certificate of two answers, spoiled by `fault` if it has a name.
Certificate certified(const Subject& subject, const std::string& fault, const voxel::Octree& octree,
                      const brep::Triangles& triangles, const Witness& witness);

/// An answer with a box or without it.
voxel::Octree changed(const voxel::Octree& octree, const voxel::Box& box, brep::Operation operation);
brep::Triangles changed(const brep::Triangles& triangles, const voxel::Box& box, brep::Operation operation);
brep::Triangles shifted(brep::Triangles triangles, const glm::dvec3& by_mm);
/// The triangles and, beside them, those of another surface.
brep::Triangles with_shell_again(brep::Triangles triangles, const brep::Triangles& again);

/// Subjects without a symmetry that would hide a mirrored axis or swapped operands: off the middle, askew,
/// cut. The ellipsoid or the ring; and the head.
Subject shape_subject(const std::string& name, int voxels);
Subject head_subject(int voxels);

}  // namespace octotomy::verify
