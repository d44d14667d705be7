// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Where axes are parallel, the volume that two voxels share is a product of three lengths. The lengths along the
// first axis are added up for a row, rows for a plane, and planes for the lattice.
#include "voxel/archive/occupancy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "voxel/tree/slice_bits.h"

namespace octotomy::voxel {
namespace {

/// The index of a voxel of the lattice along one axis, and the length within it that a voxel of the octree
/// covers.
struct Covered {
  int at = 0;
  double length = 0.0;
};

/// An axis of the octree, and the parallel axis of the lattice.
struct Along {
  int axis = 0;  ///< number of the lattice's axis
  /// Step between neighbouring samples along this axis of the lattice.
  std::size_t stride = 1;
  /// For each voxel of the octree along its axis, the parts of lattice voxels that it covers.
  std::vector<std::vector<Covered>> covered = {};
};

/// The lattice voxels, of `count` along an axis, that an octree voxel covers, and the covered lengths.
/// Centre, edge and lengths are in lattice voxels.
std::vector<Covered> covered_by(double centre, double edge, int count) {
  std::vector<Covered> covered;
  const double low = centre - 0.5 * edge, high = centre + 0.5 * edge;
  const int first = std::max(0, static_cast<int>(std::floor(low + 0.5)));
  const int last = std::min(count - 1, static_cast<int>(std::floor(high + 0.5)));
  for (int i = first; i <= last; ++i)
    if (const double length = std::min(high, i + 0.5) - std::max(low, i - 0.5); length > 0.0)
      covered.push_back({i, length});
  return covered;
}

/// For each axis of the octree the parallel axis of the lattice; none unless all axes are parallel.
std::optional<std::array<Along, 3>> axes_along(const Universe& universe, const Lattice& lattice) {
  const glm::dmat4 lattice_from_octree = glm::inverse(lattice.lps_from_voxel) * universe.lps_from_voxel;
  const std::array<std::size_t, 3> strides{
      1, static_cast<std::size_t>(lattice.dims.x),
      static_cast<std::size_t>(lattice.dims.x) * static_cast<std::size_t>(lattice.dims.y)};
  // Rounded numbers in headers change an axis's direction by less than this, in radians. Across the whole
  // universe such a change shifts no voxel by more than a small part of its edge.
  constexpr double most_turn = 1e-6;
  std::array<Along, 3> axes;
  std::array<bool, 3> is_taken{};
  for (int own = 0; own < 3; ++own) {
    const glm::dvec3 step(lattice_from_octree[own]);
    const glm::dvec3 size = glm::abs(step);
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    for (int other = 0; other < 3; ++other)
      if (other != axis && size[other] > most_turn * size[axis]) return std::nullopt;
    if (std::exchange(is_taken[static_cast<std::size_t>(axis)], true)) return std::nullopt;
    Along& along = axes[static_cast<std::size_t>(own)];
    along.axis = axis;
    along.stride = strides[static_cast<std::size_t>(axis)];
    for (int i = 0; i < universe.side(); ++i)
      along.covered.push_back(
          covered_by(lattice_from_octree[3][axis] + step[axis] * i, size[axis], lattice.dims[axis]));
  }
  return axes;
}

}  // namespace

std::optional<std::vector<double>> occupancy(const Octree& octree, const Lattice& lattice,
                                             const Progress& progress) {
  const auto axes = axes_along(octree.universe(), lattice);
  if (!axes) return std::nullopt;
  const auto& [along_x, along_y, along_z] = *axes;
  const auto row_length = static_cast<std::size_t>(lattice.dims[along_x.axis]);
  const auto row_count = static_cast<std::size_t>(lattice.dims[along_y.axis]);
  std::vector<double> shares(lattice.sample_count(), 0.0), row(row_length), plane(row_length * row_count);
  const int side = octree.universe().side();
  SliceBits slice;
  for (int z = 0; z < side; ++z) {
    progress.at(static_cast<double>(z) / side);
    if (along_z.covered[static_cast<std::size_t>(z)].empty()) continue;
    read_slice(octree, z, slice);
    std::fill(plane.begin(), plane.end(), 0.0);
    bool is_held = false;
    for (int y = 0; y < side; ++y) {
      const auto& rows = along_y.covered[static_cast<std::size_t>(y)];
      const std::uint64_t* const words = slice.row(y);
      if (rows.empty() ||
          std::all_of(words, words + slice.words_per_row, [](auto word) { return word == 0; }))
        continue;
      is_held = true;
      std::fill(row.begin(), row.end(), 0.0);
      for (int x = 0; x < side; ++x)
        if ((words[x / 64] >> (x % 64)) & 1)
          for (const Covered& each : along_x.covered[static_cast<std::size_t>(x)])
            row[static_cast<std::size_t>(each.at)] += each.length;
      for (const Covered& each : rows)
        for (std::size_t i = 0; i < row_length; ++i)
          plane[static_cast<std::size_t>(each.at) * row_length + i] += each.length * row[i];
    }
    if (!is_held) continue;
    for (const Covered& each : along_z.covered[static_cast<std::size_t>(z)])
      for (std::size_t j = 0; j < row_count; ++j)
        for (std::size_t i = 0; i < row_length; ++i)
          shares[static_cast<std::size_t>(each.at) * along_z.stride + j * along_y.stride +
                 i * along_x.stride] += each.length * plane[j * row_length + i];
  }
  return shares;
}

}  // namespace octotomy::voxel
