// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/solid.h"
#include "verify/certificate/boundary_model.h"
#include "verify/certificate/certificate.h"
#include "verify/certificate/certify_bounded.h"
#include "voxel/measure/measure.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

// The terms of the tolerances of certify_bounded(): how far two right answers may lie apart.
// difference_bound.cpp has the derivations.
namespace octotomy::verify {

/// Measures of both answers, and the numbers that the bound is computed from.
struct Evidence {
  voxel::Measures voxels;
  brep::Measures mesh;
  BoundaryModel model;
  glm::dvec3 voxel_mm{1.0};
  glm::dvec3 sample_mm{1.0};  ///< the scan's spacing, at most 2 voxels and at most 3 times the finest
  double voxel_mm3 = 1.0;
  double unseen_mm3 = 0.0;  ///< half a voxel times the area of cuts that were declared and not found
  VolumeSpread border;
  bool witnessed = false;      ///< a witness judges every place separately
  bool totals_decide = false;  ///< the witness judges places more coarsely than totals
  VolumeSpread apart;          ///< layer between surfaces that each kernel measured for itself
};

/// Measures both objects and models the solid's boundary. Reports progress from 0 to 0.2. Throws
/// voxel::Stopped.
Evidence evidence_of(const voxel::Octree& octree, const brep::Solid& solid, const BoundInputs& inputs,
                     const voxel::Progress& progress);

/// Sets the terms of the volume's tolerance, and their sum.
void derive_volume_tolerance(Certificate& certificate, const Evidence& evidence);
/// Sets the tolerances of the symmetric difference and of the centroid. Precondition: the terms of the
/// volume's tolerance are set.
void derive_other_tolerances(Certificate& certificate, const Evidence& evidence);
/// The tolerance of a component of the inertia tensor, whose largest component is `largest_mm5`. Precondition: the
/// tolerances of volume and centroid are set.
double inertia_tolerance_mm5(const Certificate& certificate, const Evidence& evidence, double largest_mm5);
/// The tolerance of the area by the Crofton formula; `thin_mm2` is the area of parts thinner than a voxel.
double area_tolerance_mm2(const Evidence& evidence, double thin_mm2);

struct DistanceBounds {
  double percentile95_mm = 0.0, mean_mm = 0.0;
};
DistanceBounds distance_bounds(const Evidence& evidence);

/// The longest of three edges or extents.
double longest(const glm::dvec3& edges_mm);

/// A coordinate within this distance of a box's side counts as lying on that side: a bound for the rounding
/// of cuts at the box.
double on_border_mm(const voxel::Box& box_mm);

}  // namespace octotomy::verify
