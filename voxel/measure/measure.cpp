// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/measure/measure.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <mutex>
#include <numbers>
#include <tbb/parallel_for.h>
#include <vector>

#include "voxel/measure/cell_counts.h"
#include "voxel/measure/crofton.h"
#include "voxel/measure/distance_map.h"
#include "voxel/space/vector_clones.h"
#include "voxel/tree/slice_bits.h"

// Area by the Crofton formula: the area of a boundary is four times the mean, over all directions, of the
// number of entries of parallel lines times the area per line. Here the 13 directions to a voxel's 26
// neighbours represent all directions. Along each direction, the lines run through the lattice's points:
// crossings are pairs of neighbours with one inside, and the area per line is the voxel's volume divided by
// the step's length. Source: Ohser and Muecklich, Statistical Analysis of Microstructures, 2000, section 4.2;
// weights as in Lang, Ohser and Hilfer, J. Microscopy 203, 2001. Departure: a direction's weight is the share
// of the sphere nearest to it, computed for the lattice's own spacing on a fine grid of directions, so that
// anisotropic voxels have no bias either.

namespace octotomy::voxel {
namespace {

constexpr std::array<std::array<int, 3>, 13> directions{{{1, 0, 0},
                                                         {0, 1, 0},
                                                         {0, 0, 1},
                                                         {1, 1, 0},
                                                         {-1, 1, 0},
                                                         {1, 0, 1},
                                                         {-1, 0, 1},
                                                         {0, 1, 1},
                                                         {0, -1, 1},
                                                         {1, 1, 1},
                                                         {-1, 1, 1},
                                                         {1, -1, 1},
                                                         {-1, -1, 1}}};

glm::dvec3 step_mm(const Lattice& lattice, const std::array<int, 3>& direction) {
  return glm::dmat3(lattice.lps_from_voxel) * glm::dvec3(direction[0], direction[1], direction[2]);
}

// For each of the 13 directions the share of all directions that are nearest to it, counted on an equal-area
// grid of the half sphere. With 400 x 400 grid points the error, which arises at points on the cells'
// boundaries, is below 0.1 % of a weight.
std::array<double, 13> summed_shares(const Lattice& lattice) {
  std::array<glm::dvec3, 13> unit;
  for (std::size_t d = 0; d < unit.size(); ++d) unit[d] = glm::normalize(step_mm(lattice, directions[d]));
  std::array<double, 13> share{};
  constexpr int fineness = 400;
  for (int i = 0; i < fineness; ++i)
    for (int j = 0; j < fineness; ++j) {
      const double z = (i + 0.5) / fineness;
      const double turn = 2.0 * std::numbers::pi * (j + 0.5) / fineness;
      const double level = std::sqrt(1.0 - z * z);
      const glm::dvec3 way(level * std::cos(turn), level * std::sin(turn), z);
      std::size_t nearest = 0;
      double most = -1.0;
      for (std::size_t d = 0; d < unit.size(); ++d)
        if (const double along = std::abs(glm::dot(way, unit[d])); along > most) {
          most = along;
          nearest = d;
        }
      share[nearest] += 1.0 / (static_cast<double>(fineness) * fineness);
    }
  return share;
}

// Caches the shares of the last lattice. All objects of a plan have the same lattice, and computing the
// shares takes longer than measuring a small object.
std::array<double, 13> shares(const Lattice& lattice) {
  static std::mutex mutex;
  static glm::dmat3 known(0.0);
  static std::array<double, 13> share{};
  const glm::dmat3 edges(lattice.lps_from_voxel);
  const std::lock_guard lock(mutex);
  if (known != edges) {
    share = summed_shares(lattice);
    known = edges;
  }
  return share;
}

// Counts the voxels x of a row that differ from voxel x + shift of another row. Voxels beyond a row's ends
// are outside. Bit x of a shifted word is voxel x + shift.
OCTOTOMY_VECTOR_CLONES std::uint64_t differing(const std::uint64_t* row, const std::uint64_t* other,
                                               int words, int shift) {
  std::uint64_t count = 0;
  for (int i = 0; i < words; ++i) {
    std::uint64_t shifted = other[i];
    if (shift > 0) shifted = (other[i] >> 1) | (i + 1 < words ? other[i + 1] << 63 : 0);
    if (shift < 0) shifted = (other[i] << 1) | (i > 0 ? other[i - 1] >> 63 : 0);
    count += static_cast<std::uint64_t>(std::popcount(row[i] ^ shifted));
  }
  return count;
}

// Sums over a run of slices: first and second moments, and the numbers of boundary pairs by direction.
class Sums {
 public:
  // For each direction the number of pairs of neighbours with exactly one inside the object, pairs across the
  // universe's faces included.
  std::array<std::uint64_t, 13> crossings{};
  glm::dvec3 first_moment{0.0};   ///< sum of voxel indices: exact below 2^53
  glm::dmat3 second_moment{0.0};  ///< sum of products of two voxel indices; only the lower triangle is used

  // Counts the pairs (v, v - direction) with v in slice z, including v in the rows just outside the slice.
  // `none` is an empty row.
  void add_slice(const SliceBits& below, const SliceBits& slice, const std::uint64_t* none, int z) {
    const int words = slice.words_per_row, side = slice.side;
    const auto row_of = [&](const SliceBits& bits, int y) {
      return y < 0 || y >= side || is_empty(bits.row(y), words) ? none : bits.row(y);
    };
    std::array<const std::uint64_t*, 3> here{none, none, row_of(slice, 0)},
        under{none, none, row_of(below, 0)};
    for (int y = -1; y <= side; ++y) {
      // Now the arrays contain the rows y - 1, y and y + 1.
      std::rotate(here.begin(), here.begin() + (y >= 0), here.end());
      std::rotate(under.begin(), under.begin() + (y >= 0), under.end());
      if (y >= 0) {
        here[2] = row_of(slice, y + 1);
        under[2] = row_of(below, y + 1);
      }
      if (here[1] != none) add_moments(here[1], words, y, z);
      for (std::size_t d = 0; d < directions.size(); ++d) {
        const auto [dx, dy, dz] = directions[d];
        const std::uint64_t* there = (dz == 1 ? under : here)[static_cast<std::size_t>(1 - dy)];
        if (here[1] != none || there != none) crossings[d] += pairs(here[1], there, words, side, dx);
      }
    }
  }

  void add(const Sums& other) {
    for (std::size_t d = 0; d < crossings.size(); ++d) crossings[d] += other.crossings[d];
    first_moment += other.first_moment;
    second_moment += other.second_moment;
  }

 private:
  static bool is_empty(const std::uint64_t* row, int words) {
    return std::all_of(row, row + words, [](std::uint64_t word) { return word == 0; });
  }

  // Counts the pairs of voxel x of `here` with voxel x - dx of `there` of which exactly one is set.
  static std::uint64_t pairs(const std::uint64_t* here, const std::uint64_t* there, int words, int side,
                             int dx) {
    std::uint64_t count = differing(here, there, words, -dx);
    // The last voxel of the row forms a pair with a voxel outside the row. The shifted word contains this
    // pair unless the row ends at the end of a word.
    if (dx == 1 && side % 64 == 0) count += there[words - 1] >> 63;
    if (dx == -1) count += there[0] & 1;
    return count;
  }

  void add_moments(const std::uint64_t* row, int words, int y, int z) {
    double count = 0.0;
    double sum_x = 0.0;
    double sum_xx = 0.0;
    for (int i = 0; i < words; ++i) {
      std::uint64_t word = row[i];
      if (word == 0) continue;
      const int bits = std::popcount(word);
      count += bits;
      const double first = 64.0 * i;
      const double place_sum = sum_of_places(word);
      sum_x += first * bits + place_sum;
      sum_xx += first * (first * bits + 2.0 * place_sum) + sum_of_square_places(word);
    }
    if (count == 0.0) return;
    first_moment += glm::dvec3(sum_x, count * y, count * z);
    second_moment[0] += glm::dvec3(sum_xx, sum_x * y, sum_x * z);
    second_moment[1] += glm::dvec3(0.0, count * y * y, count * y * z);
    second_moment[2].z += count * z * z;
  }

  // Entry k is a mask of those bits of a word whose index has bit k set.
  static constexpr std::array<std::uint64_t, 6> places{0xaaaaaaaaaaaaaaaa, 0xcccccccccccccccc,
                                                       0xf0f0f0f0f0f0f0f0, 0xff00ff00ff00ff00,
                                                       0xffff0000ffff0000, 0xffffffff00000000};

  // The sum of the indices of a word's set bits, in which bit k of an index counts 2^k.
  static double sum_of_places(std::uint64_t word) {
    int sum = 0;
    for (std::size_t k = 0; k < places.size(); ++k) sum += std::popcount(word & places[k]) << k;
    return sum;
  }

  // The sum of the squares of the indices of a word's set bits, in which a pair of bits j and k of an index
  // counts 2^(j + k).
  static double sum_of_square_places(std::uint64_t word) {
    if (word == all_children) return 63.0 * 64.0 * 127.0 / 6.0;
    int sum = 0;
    for (std::size_t j = 0; j < places.size(); ++j) {
      sum += std::popcount(word & places[j]) << (2 * j);
      for (std::size_t k = 0; k < j; ++k) sum += std::popcount(word & places[j] & places[k]) << (j + k + 1);
    }
    return sum;
  }
};

// The division into runs of slices is fixed, so that even sums that are rounded do not depend on the number
// of threads.
Sums sums_of(const Octree& octree) {
  constexpr int run = 16;
  const int side = octree.universe().side(), words = (side + 63) / 64;
  const std::vector<std::uint64_t> none(static_cast<std::size_t>(words), 0);
  // One empty slice is added beyond the last one, to count the last slice's upper neighbours.
  std::vector<Sums> parts(static_cast<std::size_t>((side + run) / run));
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    const auto read = [&](int z, SliceBits& slice) {
      if (z >= 0 && z < side) return read_slice(octree, z, slice);
      slice.side = side;
      slice.words_per_row = words;
      slice.words.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(words), 0);
    };
    const int begin = static_cast<int>(part) * run;
    SliceBits below, slice;
    read(begin - 1, below);
    for (int z = begin; z < std::min(begin + run, side + 1); ++z) {
      read(z, slice);
      parts[part].add_slice(below, slice, none.data(), z);
      std::swap(below, slice);
    }
  });
  Sums sums;
  for (const Sums& part : parts) sums.add(part);
  return sums;
}

// Lindblad's weight of a pattern of 2 x 2 x 2 voxels, in squares of the voxel's edge. A pattern of more than
// four voxels has the weight of its complement. Which of the 14 cases it is follows from the number of voxels
// and of their neighbours by faces.
double lindblad_weight(unsigned pattern) {
  assert(pattern > 0 && pattern < 255);
  if (std::popcount(pattern) > 4) pattern = ~pattern & 255U;
  int joints = 0;
  int most_joints = 0;
  for (unsigned v = 0; v < 8; ++v) {
    if ((pattern >> v & 1U) == 0) continue;
    int own = 0;
    for (const unsigned step : {1U, 2U, 4U}) own += static_cast<int>(pattern >> (v ^ step) & 1U);
    joints += own;
    most_joints = std::max(most_joints, own);
  }
  joints /= 2;
  switch (std::popcount(pattern)) {
    case 1:
      return 0.636;
    case 2:
      return joints == 1 ? 0.669 : 1.272;
    case 3:
      return joints == 2 ? 0.554 : joints == 1 ? 1.305 : 1.908;
    default:
      break;
  }
  if (joints == 4) return 0.927;                             // a face
  if (joints == 3) return most_joints == 3 ? 0.422 : 1.573;  // a corner and its neighbours; a chain
  if (joints == 2) return most_joints == 1 ? 1.338 : 1.190;  // two edges; three of a face and one apart
  return 2.544;
}

std::optional<double> lindblad_mm2(const Octree& octree) {
  const Lattice lattice = octree.universe().lattice();
  const glm::dvec3 edge_mm = lattice.spacing_mm();
  // Voxels are cubes if edges and volume agree to a millionth; the weights have three digits.
  constexpr double slack = 1e-6;
  const double cube_mm3 = edge_mm.x * edge_mm.x * edge_mm.x;
  if (std::abs(edge_mm.y / edge_mm.x - 1.0) > slack || std::abs(edge_mm.z / edge_mm.x - 1.0) > slack ||
      std::abs(lattice.voxel_mm3() / cube_mm3 - 1.0) > 4.0 * slack)
    return std::nullopt;
  const std::array<std::uint64_t, 256> counts = cell_counts(octree);
  double squares = 0.0;
  for (unsigned pattern = 1; pattern < 255; ++pattern)
    squares += lindblad_weight(pattern) * static_cast<double>(counts[pattern]);
  return squares * edge_mm.x * edge_mm.x;
}

// Computes the inertia from sums over voxel indices. Every voxel is a cuboid, so 1/12 is added to the
// variance along each edge.
glm::dmat3 inertia_mm5(const Lattice& lattice, double count, const glm::dvec3& first,
                       const glm::dmat3& second) {
  assert(count > 0.0);
  glm::dmat3 spread = second;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < column; ++row) spread[column][row] = spread[row][column];
  spread -= glm::outerProduct(first, first) / count;
  spread += glm::dmat3(count / 12.0);
  const glm::dmat3 edges(lattice.lps_from_voxel);
  const glm::dmat3 spread_mm5 = edges * spread * glm::transpose(edges) * lattice.voxel_mm3();
  return glm::dmat3(spread_mm5[0][0] + spread_mm5[1][1] + spread_mm5[2][2]) - spread_mm5;
}

}  // namespace

glm::dvec3 crofton13_of_flat(const Lattice& lattice) {
  const std::array<double, 13> share = shares(lattice);
  glm::dvec3 seen(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(lattice.lps_from_voxel[(axis + 1) % 3]),
                                                        glm::dvec3(lattice.lps_from_voxel[(axis + 2) % 3])));
    for (std::size_t d = 0; d < directions.size(); ++d)
      seen[axis] +=
          2.0 * share[d] * std::abs(glm::dot(normal, glm::normalize(step_mm(lattice, directions[d]))));
  }
  return seen;
}

std::optional<Box> extents_of(const Octree& octree) {
  const VoxelRange range = range_of(octree);
  if (range.is_empty()) return std::nullopt;
  Lattice part = octree.universe().lattice();
  part.lps_from_voxel[3] = glm::dvec4(part.lps_mm(glm::dvec3(range.low)), 1.0);
  part.dims = range.dims();
  return bounds(part);
}

Measures measure(const Octree& octree) {
  const Lattice lattice = octree.universe().lattice();
  Measures measures;
  measures.voxel_count = octree.voxel_count();
  measures.volume_mm3 = static_cast<double>(measures.voxel_count) * lattice.voxel_mm3();
  if (measures.voxel_count == 0) return measures;

  const Sums sums = sums_of(octree);
  measures.centroid_mm = lattice.lps_mm(sums.first_moment / static_cast<double>(measures.voxel_count));
  measures.inertia_mm5 =
      inertia_mm5(lattice, static_cast<double>(measures.voxel_count), sums.first_moment, sums.second_moment);
  measures.area_lindblad_mm2 = lindblad_mm2(octree);
  measures.extents = extents_of(octree);

  const std::array<double, 13> share = shares(lattice);
  for (std::size_t d = 0; d < directions.size(); ++d) {
    const double line_mm2 = lattice.voxel_mm3() / glm::length(step_mm(lattice, directions[d]));
    // Half of the pairs are entries; by Cauchy's formula the area is four times the mean of entries times the
    // area per line.
    measures.area_crofton13_mm2 += 4.0 * share[d] * 0.5 * static_cast<double>(sums.crossings[d]) * line_mm2;
    if (d < 3) measures.exposed_mm2[static_cast<int>(d)] = static_cast<double>(sums.crossings[d]) * line_mm2;
  }
  return measures;
}

}  // namespace octotomy::voxel
