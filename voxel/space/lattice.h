// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace octotomy::voxel {

/// The positions of samples in the patient: `dims` samples, x fastest. The sample with integer index i lies
/// at LPS position `lps_from_voxel * (i, 1)`, in millimetres. An integer index is a voxel's centre, so the
/// voxel extends from i - 1/2 to i + 1/2.
struct Lattice {
  glm::ivec3 dims{0};
  glm::dmat4 lps_from_voxel{1.0};

  /// Lengths of the three voxel edges in millimetres.
  glm::dvec3 spacing_mm() const;
  /// Volume of one voxel in cubic millimetres.
  double voxel_mm3() const;
  glm::dvec3 lps_mm(const glm::dvec3& p_voxel) const;
  glm::dvec3 voxel(const glm::dvec3& p_mm) const;
  /// Whether the three axes form a right-handed system in LPS.
  bool right_handed() const;
  std::size_t sample_count() const;

  bool operator==(const Lattice&) const = default;
};

/// An axis-aligned box in LPS millimetres.
struct Box {
  glm::dvec3 low_mm{0.0};
  glm::dvec3 high_mm{0.0};
};

/// The box that contains every voxel of the lattice, voxel edges included.
Box bounds(const Lattice& lattice);

/// A lattice with axes along LPS, whose first voxel's centre is `first_mm`.
Lattice axis_aligned_lattice(const glm::ivec3& dims, const glm::dvec3& spacing_mm,
                             const glm::dvec3& first_mm);

/// The cube of 2^depth voxels a side in which an octree lives. Index space and units are those of Lattice.
struct Universe {
  static constexpr int max_depth = 12;

  int depth = 8;  ///< 2..12: universes of 4 to 4096 voxels a side
  glm::dmat4 lps_from_voxel{1.0};

  int side() const { return 1 << depth; }
  /// The universe's voxels as a lattice of side() samples along each axis.
  Lattice lattice() const;

  bool operator==(const Universe&) const = default;
};

/// The smallest axis-aligned universe of cubic voxels that contains the box and has the same centre. Throws
/// std::invalid_argument if voxel_mm is not positive and finite, std::length_error if the universe would need
/// more than 2^Universe::max_depth voxels a side.
Universe universe_around(const Box& box, double voxel_mm);

/// The offset to add to the target's voxel indices to get the source's, if the map is a translation by whole
/// voxels; otherwise none.
std::optional<glm::ivec3> whole_voxel_offset(const glm::dmat4& source_from_target);

}  // namespace octotomy::voxel
