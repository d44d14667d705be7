// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/partial_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <span>
#include <unordered_map>

#include "convert/surface/surface_extraction.h"
#include "convert/voxel/voxelise_partial.h"
#include "voxel/space/shared_progress.h"

// 1 Marching cubes over the shares gives the topology, and places to a few hundredths of a voxel.
// 2 Each voxel's lack is its given share less the surface's own. A point moves outward by the sum of the
// lacks of the 27 voxels around it, divided by the surface's area in these voxels. 3 Pass 2 again, as the
// first move changes normals and areas.

namespace octotomy::convert {
namespace {

constexpr int rounds = 2;

/// Smallest distance of an interpolated point from a voxel's centre, as a share of the edge. Closer points
/// would make triangles that are too small for a normal.
constexpr double closest_to_sample() {
  return 0x1p-10;
}

/// The largest move, in the voxel's shortest edges: above the error of interpolation on a smooth surface
/// (0.07 for a face 0.3 from a centre, and 0.3 / r of curvature), and below a move that could make sheets a
/// voxel apart cross.
constexpr double largest_move_voxels() {
  return 0.1;
}

std::uint64_t key_of(const glm::ivec3& v) {
  constexpr int bias = 1 << 16;  // keeps the coordinates of the first voxel's neighbours from being negative
  assert(glm::all(glm::greaterThanEqual(v, glm::ivec3(-bias))) &&
         glm::all(glm::lessThan(v, glm::ivec3((1 << 20) - bias))));
  return (static_cast<std::uint64_t>(v.x + bias) << 40) | (static_cast<std::uint64_t>(v.y + bias) << 20) |
         static_cast<std::uint64_t>(v.z + bias);
}

/// A sum for each voxel of a set.
class VoxelSums {
 public:
  void add(const glm::ivec3& v, double value) { sums_[key_of(v)] += value; }
  std::optional<double> at(const glm::ivec3& v) const {
    const auto found = sums_.find(key_of(v));
    return found != sums_.end() ? std::optional(found->second) : std::nullopt;
  }
  /// The total of the sums of the 27 voxels around a voxel and itself, in a fixed order.
  double about(const glm::ivec3& v) const {
    double sum = 0.0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) sum += at(v + glm::ivec3(x, y, z)).value_or(0.0);
    return sum;
  }

 private:
  std::unordered_map<std::uint64_t, double> sums_;
};

/// Shares of the boundary voxels.
VoxelSums shares_of(const voxel::PartialOctree& partial) {
  VoxelSums shares;
  for_each_boundary_voxel(partial, [&](const glm::ivec3& v, std::uint16_t fraction) {
    shares.add(v, static_cast<double>(fraction) / voxel::PartialOctree::whole);
  });
  return shares;
}

brep::Triangles interpolated(const voxel::PartialOctree& partial, const voxel::Progress& progress) {
  const VoxelSums shares = shares_of(partial);
  const auto share = [&](const glm::ivec3& v) {
    return shares.at(v).value_or(partial.inside.contains(v) ? 1.0 : 0.0);
  };
  const auto crossing = [&](const CrossedEdge& edge) {
    glm::ivec3 next = edge.voxel;
    ++next[edge.axis];
    const double first = share(edge.voxel);
    return std::clamp((0.5 - first) / (share(next) - first), closest_to_sample(), 1.0 - closest_to_sample());
  };
  const Crossings crossings = [&](std::span<const CrossedEdge> edges, double* parts) {
    std::transform(edges.begin(), edges.end(), parts, crossing);
  };
  return extract_surface(partial.inside.universe().lattice(), inside_bits(at_least_half(partial)), crossings,
                         progress);
}

/// Pass 2: for each voxel, the volume of the solid in it less the volume within the surface.
VoxelSums lacks_of(const voxel::PartialOctree& partial, const brep::Linked& surface,
                   const voxel::Progress& progress) {
  const voxel::PartialOctree now = voxelise_partial(partial.inside.universe(), surface, progress);
  const double voxel_mm3 = partial.inside.universe().lattice().voxel_mm3();
  VoxelSums lacks;
  const auto add = [&](const voxel::PartialOctree& of, const voxel::PartialOctree& other, double sign) {
    for_each_boundary_voxel(of, [&](const glm::ivec3& v, std::uint16_t fraction) {
      lacks.add(v, sign * voxel_mm3 * fraction / voxel::PartialOctree::whole);
    });
    // Voxels that are whole in `of` and on the boundary of `other`.
    for_each_boundary_voxel(other, [&](const glm::ivec3& v, std::uint16_t) {
      if (of.inside.contains(v)) lacks.add(v, sign * voxel_mm3);
    });
  };
  add(partial, now, 1.0);
  add(now, partial, -1.0);
  return lacks;
}

void move_outward(const voxel::PartialOctree& partial, brep::Triangles& surface,
                  const voxel::Progress& progress) {
  const voxel::Lattice lattice = partial.inside.universe().lattice();
  const VoxelSums lacks_mm3 = lacks_of(partial, brep::linked(surface), progress);
  std::vector<glm::dvec3> normal_mm2(surface.points_mm.size(), glm::dvec3(0.0));
  std::vector<double> area_mm2(surface.points_mm.size(), 0.0);
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 third =
        glm::cross(surface.points_mm[b] - surface.points_mm[a], surface.points_mm[c] - surface.points_mm[a]) /
        6.0;
    for (const std::uint32_t v : {a, b, c}) {
      normal_mm2[v] += third;
      area_mm2[v] += glm::length(third);
    }
  }
  const auto voxel_of = [&](const glm::dvec3& p_mm) {
    return glm::ivec3(glm::floor(lattice.voxel(p_mm) + 0.5));
  };
  VoxelSums areas_mm2;
  for (std::size_t v = 0; v < area_mm2.size(); ++v)
    areas_mm2.add(voxel_of(surface.points_mm[v]), area_mm2[v]);
  const glm::dvec3 spacing = lattice.spacing_mm();
  const double most_mm = largest_move_voxels() * std::min({spacing.x, spacing.y, spacing.z});
  for (std::size_t v = 0; v < surface.points_mm.size(); ++v) {
    const double length = glm::length(normal_mm2[v]);
    if (length == 0.0)
      continue;  // all its triangles have no area, or their normals cancel: no direction is outward
    const glm::ivec3 voxel = voxel_of(surface.points_mm[v]);
    const double move_mm = std::clamp(lacks_mm3.about(voxel) / areas_mm2.about(voxel), -most_mm, most_mm);
    surface.points_mm[v] += move_mm / length * normal_mm2[v];
  }
}

}  // namespace

brep::Triangles isosurface(const voxel::PartialOctree& partial, const voxel::Progress& progress) {
  constexpr double first_share = 0.2;
  brep::Triangles surface = interpolated(partial, voxel::part_of(progress, 0.0, first_share));
  if (surface.faces.empty()) return surface;
  constexpr double round_share = (1.0 - first_share) / rounds;
  for (int round = 0; round < rounds; ++round)
    move_outward(
        partial, surface,
        voxel::part_of(progress, first_share + round * round_share, first_share + (round + 1) * round_share));
  return surface;
}

}  // namespace octotomy::convert
