// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/sample_surface.h"
#include "brep/mesh/solid.h"
#include "brep/mesh/triangles.h"
#include "verify/certificate/certificate.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// Distances between the surfaces of an octree and of a solid, in both directions: from the centres of the
/// octree's boundary faces to the triangles, and from points spread over the triangles, at most two voxels
/// apart, to the boundary faces. Each point stands for its share of the area.
class SurfaceDistances {
 public:
  /// Measures every point. With `sampled`, mean and percentile use one random point of each run of
  /// neighbours, at most 32,768 points in each direction; the largest distance always covers all points.
  /// Preconditions: neither object is empty, and the universe's axes are perpendicular. Keeps references to
  /// both objects. Parallel; same answer on any thread count. Points lie on `measured`, the solid's triangles
  /// or some of them.
  SurfaceDistances(const voxel::Octree& octree, const brep::Solid& solid, const brep::Triangles& measured,
                   bool sampled);

  /// The larger one of both directions' means.
  double mean_mm() const;
  /// The smallest distance that at least 95 % of the area does not exceed, in the direction where it is
  /// larger.
  double percentile95_mm() const;
  double largest_mm() const;
  /// The place of the largest distance, and the kernel that has a part there.
  WorstPlace worst() const;

  /// Removes the points of the solid on sheets and gaps thinner than a voxel, because voxels cannot represent
  /// those. Returns the area of these sheets and gaps in mm2, estimated if points were sampled. From then on
  /// the largest distance covers only the points that mean and percentile use.
  double leave_out_thin();
  /// Removes the points of the solid farther than reach_mm from the boundary of `digitised`, the voxels whose
  /// centres lie inside the solid. Voxels cannot represent the surface there: rims of thin sheets, and thin
  /// rods. leave_out_thin() does not find those, because they are thick along their own normals. Returns
  /// their area as leave_out_thin() does.
  double leave_out_unheld(const voxel::Octree& digitised, double reach_mm);
  /// Removes from both surfaces the points in or beside these voxels. A surface without remaining points
  /// has the distance 0. Precondition: the voxels are in the order of before().
  void leave_out_beside(const std::vector<glm::ivec3>& voxels);

  /// Points of one surface.
  struct Points {
    std::vector<glm::dvec3> p_mm;
    std::vector<double> areas_mm2;
  };
  /// The distances of one surface's points from the other surface.
  struct Directed {
    std::vector<double> distances_mm, areas_mm2;  ///< of the points that mean and percentile use
    std::vector<std::uint32_t> numbers;           ///< of the same points
    double largest_mm = 0.0;
    glm::dvec3 farthest_mm{0.0};
    double mean_mm = 0.0, percentile95_mm = 0.0;

    void sum_up();
  };

 private:
  /// Removes the marked points of from_solid_. Returns the area that they represent, estimated if points were
  /// sampled.
  double leave_out(const std::vector<std::uint8_t>& is_out);

  const voxel::Octree& octree_;
  const brep::Solid& solid_;
  brep::SurfaceSamples samples_;    ///< of the solid
  double mm2_a_sampled_mm2_ = 1.0;  ///< area of the solid for each mm2 of from_solid_'s points
  Directed from_voxels_, from_solid_;
};

}  // namespace octotomy::verify
