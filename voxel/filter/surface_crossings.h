// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/solid/membership.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

/// Where a solid's surface crosses the edges between neighbouring voxels' centres. Positions are in voxels.
/// `octree` holds the solid's voxels and alone decides on which side a centre lies; `solid` determines the
/// position of the crossing on the edge. The object stores copies of both. Cost: eight queries of `solid` for
/// each face of the octree.
class SurfaceCrossings {
 public:
  SurfaceCrossings(const Octree& octree, const Expression& solid);

  const std::vector<glm::dvec3>& points() const { return points_; }
  /// The crossings, the middles of the chords between two crossings in a lattice square, and the middles of
  /// the cells whose crossings form one ring.
  std::vector<glm::dvec3> with_middles() const;
  /// Calls `visit`, from several threads, with the triangles of a surface through the crossings. In each
  /// cell, a fan joins the ring of crossings to its middle, which is moved outward to the solid's surface, so
  /// that little of the solid's edges is cut off. Neighbouring cells share the chords of their rings, so that
  /// the surface is closed where the solid ends within the universe. The triangles' winding is arbitrary.
  void for_triangles(const std::function<void(const std::array<glm::dvec3, 3>& corners)>& visit) const;

 private:
  using Middle = std::pair<bool, glm::dvec3>;
  using Chord = std::pair<std::size_t, std::size_t>;

  std::size_t crossing(const glm::ivec3& from, int axis) const;
  std::vector<std::size_t> of_square(const glm::ivec3& low, int normal) const;
  void add_chords(const glm::ivec3& low, int normal, std::vector<Chord>& chords) const;
  Middle middle_of_chord(std::uint64_t square) const;
  Middle middle_of_ring(const glm::ivec3& low) const;
  glm::dvec3 outer_middle(const std::vector<std::size_t>& ring, const glm::ivec3& low,
                          const Membership& contains) const;
  std::vector<std::uint64_t> cells() const;

  Octree octree_;
  Expression solid_;
  std::vector<std::uint64_t> keys_;  ///< ascending
  std::vector<glm::dvec3> points_;
};

}  // namespace octotomy::voxel
