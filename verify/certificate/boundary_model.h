// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/solid.h"
#include "voxel/space/lattice.h"

// Models the errors of a solid's boundary: of counting voxel centres inside it, and of computing it as an
// isosurface of samples. The source has the derivations.
namespace octotomy::verify {

/// A signed volume that a boundary gains, and its first moment about a point.
struct VolumeShift {
  double mm3 = 0.0;
  glm::dvec3 mm4{0.0};
  void add(double volume_mm3, const glm::dvec3& arm_mm) {
    mm3 += volume_mm3;
    mm4 += volume_mm3 * arm_mm;
  }
};

/// An unsigned volume, and the volume times its arm and its arm squared.
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
  glm::dvec3 flat_mm2{0.0};   ///< area of planes along the universe's planes, by the axis of their normal
  double coherent_mm2 = 0.0;  ///< area of all planes whose normal has small integers in voxels
  /// Volume by which counting centres displaces the planes of `coherent_mm2`: exact, with its sign.
  VolumeShift planes;
  VolumeSpread planes_without_sign;
  /// The shift of boundary that is curved or rough but nearly along the lattice, as a plane is after blur and
  /// noise.
  VolumeShift nearly_planes;
  /// Area gained or lost past the rims of `planes` and `nearly_planes`: the rims' length times the displacement.
  double rims_mm2 = 0.0;
  /// Displacement of unknown sign: of planes through voxel centres and of the rims of planes. An isosurface
  /// chamfers a rim over the width of a sample, so the rim is not found to be flat.
  VolumeSpread unsure;
  double tied_mm3 = 0.0;  ///< the part of planes through voxel centres: half a layer of voxels
  /// The variance of a count over all positions of the lattice, for the boundary outside lattice planes: in mm6,
  /// times the arm squared, and times the fourth power of the arm.
  double count_mm6 = 0.0, count_mm8 = 0.0, count_mm10 = 0.0;
  /// The integral of mean curvature in units of samples: half the sum over edges of length times angle times
  /// the squared spacing of samples across the edge, positive for convex edges. `bent` keeps the sign;
  /// `bent_without_sign` adds the absolute values of cells of three samples a side.
  VolumeShift bent;
  VolumeSpread bent_without_sign;
  double curvature_mm = 0.0;  ///< the integral of absolute mean curvature, by the same cells
  /// Area that lattice lines miss at sharp edges beyond 0.3 times the mean curvature, per millimetre of voxel edge.
  double sharp_mm = 0.0;
  /// The Crofton formula with 13 directions on these triangles, in the limit of fine voxels.
  double crofton13_mm2 = 0.0;
};

struct BoundaryFrame {
  voxel::Lattice lattice;             ///< whose centres count the inside
  glm::dvec3 sample_spacing_mm{1.0};  ///< of the isosurface's samples, along the LPS axes
  glm::dvec3 about_mm{0.0};           ///< origin of the moments
};
/// Cost: linear in the solid's edges, parallel.
BoundaryModel boundary_model(const brep::Solid& solid, const BoundaryFrame& frame);

}  // namespace octotomy::verify
