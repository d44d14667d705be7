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

/// Result of the comparison of both kernels' answers with the witness.
struct Places {
  /// Voxels at which a kernel contradicts the witness, or at which the kernels contradict each other away
  /// from any surface.
  std::uint64_t voxel_count = 0;
  std::uint64_t largest_count = 0;  ///< voxels of the largest group that touch by faces, edges or corners
  double stray_mm2 = 0.0;           ///< area of triangles where the witness has no surface
  /// The largest group of such voxels; if there is none, the largest such triangle.
  std::optional<WorstPlace> worst;
  /// Parts that one kernel joins to the object by a thin_neck and the other kernel cuts there, the largest
  /// first. Neither kernel is wrong, because the scan does not show whether the neck is present.
  std::vector<OpenPart> open;
  /// Voxels of the parts that resampling lost or filled, in the order of before(). There the kernels differ,
  /// and the witness agrees with the mesh but allows the voxels either answer (`untold`). Groups of fewer
  /// than eight touching voxels are left out, because chance decides about them.
  std::vector<glm::ivec3> lost;
  std::optional<WorstPlace> worst_lost = {};  ///< the largest such group
  DetectionLimit limit;
};

/// Compares with the witness the voxels at which the two kernels differ, the voxels beside the octree's
/// boundary, and the solid's vertices and triangle centroids. `digitised` are the voxels whose centre lies
/// inside the solid. Throws voxel::Stopped. Parallel; same answer on any thread count. Cost: one reading for
/// each of these points; for the limit some ten thousand more, and a sort of the solid's pieces.
Places judge_places(const voxel::Octree& octree, const voxel::Octree& digitised, const brep::Solid& solid,
                    const Witness& witness, const voxel::Progress& progress = {});

/// As judge_places(), but without the limit, which is left at zero.
Places contradicted_places(const voxel::Octree& octree, const voxel::Octree& digitised,
                           const brep::Solid& solid, const Witness& witness);

/// Returns the parts that one kernel alone joins to an object by thin necks, the largest first. Cost:
/// digitises the solid and reads the witness at each voxel where the kernels differ.
std::vector<OpenPart> open_parts(const voxel::Octree& octree, const brep::Solid& solid,
                                 const Witness& witness);

}  // namespace octotomy::verify
