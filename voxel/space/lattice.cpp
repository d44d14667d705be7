// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/lattice.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

// The tolerance in voxels for translations by whole voxels. Converting millimetres to voxel indices rounds
// numbers below 2^12 a few times, an error of 1e-12 of a voxel. A translation that is not meant to be by
// whole voxels deviates from one by far more than a millionth.
constexpr double whole_voxel_tolerance = 1e-6;

}  // namespace

glm::dvec3 Lattice::spacing_mm() const {
  return {glm::length(glm::dvec3(lps_from_voxel[0])), glm::length(glm::dvec3(lps_from_voxel[1])),
          glm::length(glm::dvec3(lps_from_voxel[2]))};
}

double Lattice::voxel_mm3() const {
  return std::abs(glm::determinant(glm::dmat3(lps_from_voxel)));
}

glm::dvec3 Lattice::lps_mm(const glm::dvec3& p_voxel) const {
  return glm::dvec3(lps_from_voxel * glm::dvec4(p_voxel, 1.0));
}

glm::dvec3 Lattice::voxel(const glm::dvec3& p_mm) const {
  return glm::inverse(glm::dmat3(lps_from_voxel)) * (p_mm - glm::dvec3(lps_from_voxel[3]));
}

bool Lattice::right_handed() const {
  return glm::determinant(glm::dmat3(lps_from_voxel)) > 0.0;
}

std::size_t Lattice::sample_count() const {
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
         static_cast<std::size_t>(dims.z);
}

Box bounds(const Lattice& lattice) {
  Box box{glm::dvec3(std::numeric_limits<double>::infinity()),
          glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 side(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 p_mm = lattice.lps_mm(side * glm::dvec3(lattice.dims) - 0.5);
    box.low_mm = glm::min(box.low_mm, p_mm);
    box.high_mm = glm::max(box.high_mm, p_mm);
  }
  return box;
}

Lattice axis_aligned_lattice(const glm::ivec3& dims, const glm::dvec3& spacing_mm,
                             const glm::dvec3& first_mm) {
  glm::dmat4 lps_from_voxel(1.0);
  for (int axis = 0; axis < 3; ++axis) lps_from_voxel[axis][axis] = spacing_mm[axis];
  lps_from_voxel[3] = glm::dvec4(first_mm, 1.0);
  return {dims, lps_from_voxel};
}

Lattice Universe::lattice() const {
  return {glm::ivec3(side()), lps_from_voxel};
}

Universe universe_around(const Box& box, double voxel_mm) {
  if (!std::isfinite(voxel_mm) || voxel_mm <= 0.0)
    throw InvalidInput("a universe's voxels need a positive edge, not " + std::to_string(voxel_mm) + " mm");
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  const double longest_mm = std::max(extent_mm.x, std::max(extent_mm.y, extent_mm.z));
  // If an extent is a whole number of voxels except for rounding errors, it must not lead to another level.
  const double voxels = longest_mm / voxel_mm * (1.0 - 4.0 * std::numeric_limits<double>::epsilon());
  Universe universe;
  universe.depth = 2;
  while (universe.depth < Universe::max_depth && universe.side() < voxels) ++universe.depth;
  if (!(universe.side() >= voxels))
    throw TooLarge("a box of " + std::to_string(longest_mm) + " mm takes more than " +
                   std::to_string(universe.side()) + " voxels of " + std::to_string(voxel_mm) +
                   " mm a side: choose larger voxels");
  const glm::dvec3 centre_mm = (box.low_mm + box.high_mm) * 0.5;
  const double first_mm = -0.5 * (universe.side() - 1) * voxel_mm;
  universe.lps_from_voxel =
      axis_aligned_lattice(glm::ivec3(universe.side()), glm::dvec3(voxel_mm), centre_mm + first_mm)
          .lps_from_voxel;
  return universe;
}

std::optional<glm::ivec3> whole_voxel_offset(const glm::dmat4& source_from_target) {
  glm::ivec3 offset(0);
  for (int row = 0; row < 3; ++row) {
    const glm::dvec3 gradient(source_from_target[0][row], source_from_target[1][row],
                              source_from_target[2][row]);
    const double constant = source_from_target[3][row];
    glm::dvec3 expected(0.0);
    expected[row] = 1.0;
    const glm::dvec3 stray = glm::abs(gradient - expected) * static_cast<double>(1 << Universe::max_depth);
    const double nearest = std::floor(constant + 0.5);
    if (stray.x + stray.y + stray.z + std::abs(constant - nearest) > whole_voxel_tolerance)
      return std::nullopt;
    // An offset larger than every universe is useless and may exceed the range of int.
    if (!(std::abs(nearest) < 1 << 30)) return std::nullopt;
    offset[row] = static_cast<int>(nearest);
  }
  return offset;
}

}  // namespace octotomy::voxel
