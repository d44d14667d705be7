// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/solid.h"
#include "voxel/space/lattice.h"

// Models two errors of a solid's volume and area: that of counting voxel centres inside the boundary, and
// that of replacing the boundary by an isosurface of samples. boundary_model.cpp has the derivations.
namespace octotomy::verify {

/// A signed volume gained at a boundary, and its first moment about BoundaryFrame::about_mm.
struct VolumeShift {
  double mm3 = 0.0;
  glm::dvec3 mm4{0.0};
  void add(double volume_mm3, const glm::dvec3& arm_mm) {
    mm3 += volume_mm3;
    mm4 += volume_mm3 * arm_mm;
  }
};

/// An unsigned volume, and the volume times its distance from BoundaryFrame::about_mm and times the distance
/// squared.
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
  glm::dvec3 flat_mm2{0.0};   ///< area in planes perpendicular to a lattice axis, by that axis
  double coherent_mm2 = 0.0;  ///< area in lattice planes, whose normal in voxels has small integers
  /// Signed volume by which counting centres displaces the planes of `coherent_mm2`. It is exact. Planes
  /// through voxel centres are in `unsure` instead.
  VolumeShift planes;
  VolumeSpread planes_without_sign;
  /// Signed volume by which counting centres displaces parts of the boundary that are nearly perpendicular to
  /// an axis but not flat, for instance a plane after blur and noise.
  VolumeShift nearly_planes;
  /// Area gained or lost past the rims of `planes` and `nearly_planes`: the length of the rims times the
  /// displacement.
  double rims_mm2 = 0.0;
  /// Volume of displacements of unknown sign: of planes through voxel centres, and at the rims of planes. An
  /// isosurface is chamfered there over the width of a sample, so the model finds no plane.
  VolumeSpread unsure;
  double tied_mm3 = 0.0;  ///< the share of planes through voxel centres in `unsure`: half a layer of voxels
  /// Variance of the counted volume over all positions of the lattice, for the boundary outside lattice
  /// planes (mm6). The same variance times the mean squared arm (mm8), and times the mean fourth power of the
  /// arm (mm10).
  double count_mm6 = 0.0, count_mm8 = 0.0, count_mm10 = 0.0;
  /// The integral of mean curvature in units of samples: half the sum over edges of length times angle times
  /// the squared spacing of samples across the edge, positive for convex edges. `bent` keeps the sign.
  /// `bent_without_sign` adds the absolute values of the sums over cells of three samples a side.
  VolumeShift bent;
  VolumeSpread bent_without_sign;
  double curvature_mm = 0.0;  ///< the integral of mean curvature, as the sum of the cells' absolute values
  /// Area that lattice lines miss at sharp edges, in mm2 per millimetre of voxel edge: the part beyond 0.3
  /// times the mean curvature.
  double sharp_mm = 0.0;
  /// The area that the Crofton formula with 13 directions yields for these triangles, in the limit of fine
  /// voxels.
  double crofton13_mm2 = 0.0;
};

struct BoundaryFrame {
  voxel::Lattice lattice;             ///< of the voxels; a voxel counts if its centre is inside
  glm::dvec3 sample_spacing_mm{1.0};  ///< of the samples of the isosurface, along LPS axes
  glm::dvec3 about_mm{0.0};           ///< origin of the moments
};
/// Cost: linear in the solid's edges, parallel.
BoundaryModel boundary_model(const brep::Solid& solid, const BoundaryFrame& frame);

}  // namespace octotomy::verify
