// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh.h"
#include "voxel/lattice.h"

// What theory says of the boundary of a solid when its inside is counted in voxels and when it is itself an
// isosurface of samples. Derivations are in the source.
namespace octotomy::verify {

/// Volumes that a boundary may gain or lose, and their first moment about a point.
struct VolumeShift {
  double mm3 = 0.0;
  glm::dvec3 mm4{0.0};
  void add(double volume_mm3, const glm::dvec3& arm_mm) {
    mm3 += volume_mm3;
    mm4 += volume_mm3 * arm_mm;
  }
};

/// The same without direction: an amount, and the amount times its arm and its arm squared.
struct VolumeSpread {
  double mm3 = 0.0;
  double mm4 = 0.0;
  double mm5 = 0.0;
  void add(double volume_mm3, double arm_mm) {
    mm3 += volume_mm3;
    mm4 += volume_mm3 * arm_mm;
    mm5 += volume_mm3 * arm_mm * arm_mm;
  }
};

struct BoundaryModel {
  double area_mm2 = 0.0;
  glm::dvec3 flat_mm2{0.0};   ///< of planes along the universe's own, by the axis of their normal
  double coherent_mm2 = 0.0;  ///< of all planes whose normal has small integers in voxels
  /// Planes of small integers, by where counting centres puts them: exact, with its sign.
  VolumeShift planes;
  VolumeSpread planes_without_sign;
  double rims_mm2 =
      0.0;  ///< length of such planes' rims times their displacement: what areas beside them gain
  /// Of the same kind without sign: planes through voxel centres, and rims
  /// of planes, which an isosurface chamfers over the width of a sample so that they are not seen flat.
  VolumeSpread unsure;
  double tied_mm3 = 0.0;  ///< of which planes through voxel centres: half a layer of voxels
  /// The variance of a count over all places of the lattice, of the boundary that is in no such plane: mm6,
  /// and the same times the arm squared and to the fourth.
  double count_mm6 = 0.0, count_mm8 = 0.0, count_mm10 = 0.0;
  /// Half the sum over edges of length times angle times the squared spacing of samples across the edge: the
  /// integral of mean curvature in units of samples. With its sign, and as the sum of what cells of three
  /// samples have: positive where the solid is convex.
  VolumeShift bent;
  VolumeSpread bent_without_sign;
  double curvature_mm = 0.0;  ///< the integral of mean curvature without sign, by the same cells
  /// What the Crofton formula with 13 directions answers for these triangles, in the limit of fine voxels.
  double crofton13_mm2 = 0.0;
};

/// Precondition: nothing is marked as deleted. `samples` are those that the mesh is an isosurface of: edges
/// of its cells along LPS axes. Moments are about `about_mm`. Cost: n log n in the mesh's edges.
struct BoundaryFrame {
  voxel::Lattice lattice;             ///< that the inside is counted in
  glm::dvec3 sample_spacing_mm{1.0};  ///< along the LPS axes
  glm::dvec3 about_mm{0.0};
};
BoundaryModel boundary_model(const brep::Mesh& mesh, const BoundaryFrame& frame);

}  // namespace octotomy::verify
