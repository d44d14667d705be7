// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "verify/certificate/certificate.h"
#include "verify/certificate/necks.h"
#include "verify/witness/reading.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// Both kernels' answers held against the witness, place by place.
struct Places {
  /// Voxels at which a kernel contradicts the witness, or the kernels each other away from any surface.
  std::uint64_t voxel_count = 0;
  std::uint64_t largest_count = 0;  ///< of those that touch by faces, edges or corners
  double stray_mm2 = 0.0;           ///< area of triangles where the witness has no surface
  /// The largest such group of voxels, otherwise the largest such triangle.
  std::optional<WorstPlace> worst;
  /// Parts that one kernel joins to the object by a thin_neck and the other cuts there,
  /// the largest first. No error of either: on the scan the neck may be there or not.
  std::vector<OpenPart> open;
  DetectionLimit limit;
};

/// Holds against the witness the voxels at which the two kernels differ, those beside the octree's boundary,
/// and the solid's vertices and triangles' centroids. `digitised` are the voxels whose centre lies inside of
/// the solid. Throws voxel::Stopped. Parallel; same answer on any thread count. Cost: one reading for each of
/// these points; for the limit some ten thousand more, and a sort of the solid's pieces.
Places judge_places(const voxel::Octree& octree, const voxel::Octree& digitised, const brep::Solid& solid,
                    const Witness& witness, const voxel::Progress& progress = {});

/// The same without the limit, which is left at zero.
Places contradicted_places(const voxel::Octree& octree, const voxel::Octree& digitised,
                           const brep::Solid& solid, const Witness& witness);

/// The parts that one kernel alone joins to an object by thin necks, the largest first. Cost: digitises the
/// solid and reads where the kernels differ.
std::vector<OpenPart> open_parts(const voxel::Octree& octree, const brep::Solid& solid,
                                 const Witness& witness);

}  // namespace octotomy::verify
