// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxel/winding_number.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/mesh/disjoint_sets.h"
#include "convert/voxel/slab_triangles.h"
#include "voxel/space/shared_progress.h"

// The winding number of an open surface S is that of a closed one less that of what closes it. The passes:
//
// 1 The rim of S: its edges with more triangles one way than the other, each as often as the excess. For any
// S,
//   as many rim edges enter a vertex as leave it, so that the cone C from any apex over them closes S.
// 2 Along each row of voxels, crossings of S + C by signs give the whole number n about each centre.
// 3 A voxel is inside where n - w > 1/2, w the winding number of C. Away from C, w changes no faster than the
//   law of Biot and Savart lets a current along the rim: |grad w| <= sum over edges of length / (4 pi d^2).
//   So a cube of voxels without a triangle of C where w(centre) keeps away from ... -1/2, 1/2, 3/2 ... by
//   more than that over the cube has one whole number for n to be compared with; others are divided, down to
//   single voxels.
//
// Departure from the source, which sums over all triangles by a tree: here only rims cost, a closed surface
// has none, and the decision for a cube is proven for each of its voxels.

namespace octotomy::convert {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

/// Share of the sphere about p that a triangle covers, positive seen from behind. Source: Van Oosterom,
/// Strackee, "The solid angle of a plane triangle", IEEE TBME 30(2), 1983.
double covered_share(const Triangle& triangle, const glm::dvec3& p) {
  const glm::dvec3 a = triangle[0] - p;
  const glm::dvec3 b = triangle[1] - p;
  const glm::dvec3 c = triangle[2] - p;
  const double la = glm::length(a);
  const double lb = glm::length(b);
  const double lc = glm::length(c);
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  return std::atan2(glm::dot(a, glm::cross(b, c)), below) / (2.0 * std::numbers::pi);
}

struct RimEdge {
  std::uint32_t from = 0, to = 0;
  int excess = 1;  ///< triangles along it from -> to, less those to -> from
};

/// Pass 1, in ascending order.
std::vector<RimEdge> rim_of(const brep::Triangles& surface) {
  std::vector<std::pair<std::uint64_t, int>> ways;
  ways.reserve(3 * surface.faces.size());
  for (const auto& face : surface.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = face[i];
      const std::uint32_t to = face[(i + 1) % 3];
      if (from != to)
        ways.emplace_back((std::uint64_t{std::min(from, to)} << 32) | std::max(from, to), from < to ? 1 : -1);
    }
  std::sort(ways.begin(), ways.end());
  std::vector<RimEdge> rim;
  for (std::size_t i = 0; i < ways.size();) {
    int excess = 0;
    std::size_t end = i;
    for (; end < ways.size() && ways[end].first == ways[i].first; ++end) excess += ways[end].second;
    if (excess != 0)
      rim.push_back({static_cast<std::uint32_t>(ways[i].first >> 32),
                     static_cast<std::uint32_t>(ways[i].first), excess});
    i = end;
  }
  return rim;
}

/// The cones that close a surface, and its rim, in LPS millimetres.
struct Cap {
  std::vector<Triangle> triangles;
  std::vector<std::array<glm::dvec3, 2>> edges;
};

/// How far an apex is put out of its rim's middle, in voxel edges: anything but a simple fraction, so that
/// the cap of a flat hole does not lie in a plane of voxel centres.
constexpr glm::dvec3 apex_offset_voxels{0.2718281828, 0.3141592653, 0.1414213562};

/// One cone a connected part of the rim, from the middle of its edges.
Cap cap_of(const voxel::Universe& universe, const brep::Triangles& surface) {
  const std::vector<RimEdge> rim = rim_of(surface);
  brep::DisjointSets rims(surface.points_mm.size());
  for (const RimEdge& edge : rim) rims.join(edge.from, edge.to);
  std::map<std::uint32_t, std::pair<glm::dvec3, double>> sums;
  for (const RimEdge& edge : rim) {
    auto& [sum, count] = sums[rims.set_of(edge.from)];
    sum += surface.points_mm[edge.from] + surface.points_mm[edge.to];
    count += 2.0;
  }
  Cap cap;
  for (const RimEdge& edge : rim) {
    const auto& [sum, count] = sums[rims.set_of(edge.from)];
    const glm::dvec3 apex = sum / count + glm::dmat3(universe.lps_from_voxel) * apex_offset_voxels;
    const glm::dvec3& from = surface.points_mm[edge.from];
    const glm::dvec3& to = surface.points_mm[edge.to];
    for (int i = 0; i < std::abs(edge.excess); ++i) {
      cap.triangles.push_back(edge.excess > 0 ? Triangle{to, from, apex} : Triangle{from, to, apex});
      cap.edges.push_back({from, to});
    }
  }
  return cap;
}

double distance_to_edge(const glm::dvec3& p, const std::array<glm::dvec3, 2>& edge) {
  const glm::dvec3 along = edge[1] - edge[0];
  const double t = glm::dot(p - edge[0], along) / glm::dot(along, along);
  return glm::length(p - edge[0] - std::clamp(t, 0.0, 1.0) * along);
}

/// Voxels whose centres are origin .. origin + side - 1 along each axis.
struct Cube {
  glm::ivec3 origin{0};
  int side = slab_layers;
};

/// Pass 3: the whole number that n must reach.
class Threshold {
 public:
  Threshold(const voxel::Universe& universe, const Cap& cap)
      : lattice_(universe.lattice()), cap_(cap), bounds_(cap.triangles.size()) {
    for (std::size_t t = 0; t < bounds_.size(); ++t) {
      auto& [low, high] = bounds_[t];
      low = high = lattice_.voxel(cap.triangles[t][0]);
      for (const glm::dvec3& corner : cap.triangles[t]) {
        low = glm::min(low, lattice_.voxel(corner));
        high = glm::max(high, lattice_.voxel(corner));
      }
    }
  }

  /// Calls decided(cube, number) for cubes that together are the given one.
  template <typename Decided>
  void divide(const Cube& cube, const Decided& decided) const {
    const glm::dvec3 middle = glm::dvec3(cube.origin) + 0.5 * (cube.side - 1);
    const glm::dvec3 p_mm = lattice_.lps_mm(middle);
    double share = 0.0;
    for (const Triangle& triangle : cap_.triangles) share += covered_share(triangle, p_mm);
    if (cube.side == 1 || is_one_number(cube, p_mm, share)) {
      decided(cube, static_cast<int>(std::floor(share + 0.5)) + 1);
      return;
    }
    const int side = cube.side / 4;
    for (int child = 0; child < 64; ++child)
      divide({cube.origin + side * glm::ivec3(child & 3, (child >> 2) & 3, child >> 4), side}, decided);
  }

 private:
  bool is_one_number(const Cube& cube, const glm::dvec3& middle_mm, double share) const {
    const glm::dvec3 low(cube.origin);
    const glm::dvec3 high = low + static_cast<double>(cube.side - 1);
    for (const auto& [cap_low, cap_high] : bounds_)
      if (glm::all(glm::lessThanEqual(cap_low, high)) && glm::all(glm::lessThanEqual(low, cap_high)))
        return false;
    const glm::dvec3 spacing = lattice_.spacing_mm();
    // Edges of a lattice may be oblique: no diagonal is longer than the three edges together.
    const double reach = 0.5 * (cube.side - 1) * (spacing.x + spacing.y + spacing.z);
    const double room = std::abs(share + 0.5 - std::round(share + 0.5));
    double change = 0.0;
    for (const std::array<glm::dvec3, 2>& edge : cap_.edges) {
      const double distance = distance_to_edge(middle_mm, edge) - reach;
      if (!(distance > 0.0)) return false;
      change += glm::length(edge[1] - edge[0]) * reach / (4.0 * std::numbers::pi * distance * distance);
      if (change >= room) return false;
    }
    return true;
  }

  voxel::Lattice lattice_;
  const Cap& cap_;
  std::vector<std::pair<glm::dvec3, glm::dvec3>> bounds_;  ///< of the cap's triangles, voxel numbers
};

/// Pass 2 for sixteen layers: how often the closed surface winds about each centre.
class WoundSlab {
 public:
  WoundSlab(int side, int first_z)
      : side_(side),
        first_z_(first_z),
        end_z_(std::min(first_z + slab_layers, side)),
        winds_(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * slab_layers, 0) {}

  void add_crossings_of(const Corners& corners, int sign) {
    const auto [first, end] = layers_cut(corners, side_);
    for (int z = std::max(first, first_z_); z < std::min(end, end_z_); ++z) {
      const LayerCut cut = cut_by_layer(corners, z);
      const int end_y = first_not_below(cut.to.y, 0, side_);
      for (int y = first_not_below(cut.from.y, 0, side_); y < end_y; ++y) {
        const double t = (y - cut.from.y) / (cut.to.y - cut.from.y);
        const int x = first_not_below(cut.from.x + t * (cut.to.x - cut.from.x), 0, side_);
        if (x < side_) winds_[index({x, y, z})] += cut.entering ? sign : -sign;
      }
    }
  }

  void sum_rows() {
    const auto side = static_cast<std::size_t>(side_);
    for (std::size_t row = 0; row < winds_.size(); row += side)
      std::partial_sum(winds_.begin() + static_cast<std::ptrdiff_t>(row),
                       winds_.begin() + static_cast<std::ptrdiff_t>(row + side),
                       winds_.begin() + static_cast<std::ptrdiff_t>(row));
  }

  /// The block's voxels with at least the number that `threshold` asks for.
  voxel::Block block(const glm::ivec3& block, const Threshold& threshold) const {
    std::array<std::uint16_t, 256> rows{};
    threshold.divide({block * slab_layers, slab_layers}, [&](const Cube& cube, int least) {
      const glm::ivec3 end = glm::min(cube.origin + cube.side, glm::ivec3(side_));
      for (int z = cube.origin.z; z < end.z; ++z)
        for (int y = cube.origin.y; y < end.y; ++y)
          for (int x = cube.origin.x; x < end.x; ++x)
            if (winds_[index({x, y, z})] >= least)
              rows[static_cast<std::size_t>(y % slab_layers + slab_layers * (z % slab_layers))] |=
                  static_cast<std::uint16_t>(1 << (x % slab_layers));
    });
    return leaf_block_of_rows(rows);
  }

 private:
  std::size_t index(const glm::ivec3& v) const {
    const auto side = static_cast<std::size_t>(side_);
    return (static_cast<std::size_t>(v.z - first_z_) * side + static_cast<std::size_t>(v.y)) * side +
           static_cast<std::size_t>(v.x);
  }

  int side_, first_z_, end_z_;
  std::vector<std::int32_t> winds_;
};

}  // namespace

double winding_number(const brep::Triangles& triangles, const glm::dvec3& p_mm) {
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles.faces)
    sum += covered_share({triangles.points_mm[a], triangles.points_mm[b], triangles.points_mm[c]}, p_mm);
  return sum;
}

voxel::Octree voxelise_by_winding_number(const voxel::Universe& universe, const brep::Triangles& triangles,
                                         const voxel::Progress& progress) {
  progress.at(0.0);
  std::vector<Corners> surface = triangles_in_index_space(universe, triangles);
  const Cap cap = cap_of(universe, triangles);
  const voxel::Lattice lattice = universe.lattice();
  for (const Triangle& t : cap.triangles)
    surface.push_back({lattice.voxel(t[0]), lattice.voxel(t[1]), lattice.voxel(t[2])});
  const int side = universe.side();
  const SlabLists lists =
      sort_into_slabs(surface, side, [side](const Corners& corners) { return layers_cut(corners, side); });
  const Threshold threshold(universe, cap);
  const int sign = lattice.right_handed() ? 1 : -1;

  BlockGrid grid(universe);
  voxel::SharedProgress slabs_done(progress, static_cast<std::size_t>(grid.side()));
  tbb::parallel_for(0, grid.side(), [&](int z) {
    slabs_done.one_more();
    WoundSlab slab(side, z * slab_layers);
    const auto slab_number = static_cast<std::size_t>(z);
    for (std::size_t i = lists.first[slab_number]; i < lists.first[slab_number + 1]; ++i)
      slab.add_crossings_of(surface[lists.triangles[i]], sign);
    slab.sum_rows();
    for (int y = 0; y < grid.side(); ++y)
      for (int x = 0; x < grid.side(); ++x) grid.at({x, y, z}) = slab.block({x, y, z}, threshold);
  });
  return grid.take_octree();
}

}  // namespace octotomy::convert
