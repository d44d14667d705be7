// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 halve the triangles at the median centre along the longest axis; 2 sum the moments of each node from its
// children; 3 for eight neighbouring points along a Morton curve, descend into clusters whose distance from
// the points' ball is below `nearness` cluster radii, and use the moments of the others. Departure from the
// source: no third order, because only winding numbers above and below one half are to be distinguished.
#include "brep/mesh/winding_number.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brep/mesh/for_vectors.h"
#include "brep/mesh/halving.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/triangle_cluster.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t leaf_size = 8;

/// A cluster farther away than this many of its radii is evaluated by its moments. The source calls it the
/// accuracy scale.
constexpr double nearness() {
  return 2.0;
}

using Corners = std::array<glm::dvec3, 3>;

/// Points near each other, evaluated in one descent, and their sums.
struct Points {
  static constexpr std::size_t size = 8;
  std::array<double, size> x, y, z, sum{};
};

/// Adds to each point the solid angle that the triangles cover, positive if seen from behind.
OCTOTOMY_FOR_VECTORS void add_solid_angles(std::span<const Corners> triangles, Points& points) {
  for (const Corners& t : triangles) {
    std::array<double, Points::size> above, below, angle;
    for (std::size_t k = 0; k < Points::size; ++k) {
      const double ax = t[0].x - points.x[k], ay = t[0].y - points.y[k], az = t[0].z - points.z[k];
      const double bx = t[1].x - points.x[k], by = t[1].y - points.y[k], bz = t[1].z - points.z[k];
      const double cx = t[2].x - points.x[k], cy = t[2].y - points.y[k], cz = t[2].z - points.z[k];
      const double la = std::sqrt(ax * ax + ay * ay + az * az), lb = std::sqrt(bx * bx + by * by + bz * bz),
                   lc = std::sqrt(cx * cx + cy * cy + cz * cz);
      below[k] = la * lb * lc + (ax * bx + ay * by + az * bz) * lc + (bx * cx + by * cy + bz * cz) * la +
                 (cx * ax + cy * ay + cz * az) * lb;
      above[k] = ax * (by * cz - cy * bz) + ay * (bz * cx - cz * bx) + az * (bx * cy - cx * by);
      // For a small angle the series is accurate to 1e-7.
      const double tangent = above[k] / below[k], t2 = tangent * tangent;
      angle[k] = 2.0 * tangent * (1.0 - t2 * (1.0 / 3.0 - t2 * (1.0 / 5.0 - t2 * (1.0 / 7.0 - t2 / 9.0))));
    }
    for (std::size_t k = 0; k < Points::size; ++k)
      if (!(below[k] > 4.0 * std::abs(above[k])))
        angle[k] = above[k] == 0.0 && below[k] == 0.0 ? 0.0 : 2.0 * std::atan2(above[k], below[k]);
    for (std::size_t k = 0; k < Points::size; ++k) points.sum[k] += angle[k];
  }
}

/// Adds the solid angle of a cluster at each point: the gradient of 1 / r and its derivative, applied to the
/// area vectors and their first moment.
OCTOTOMY_FOR_VECTORS void add_moments(const TriangleCluster& cluster, Points& points) {
  const glm::dmat3 m = cluster.moment;
  const glm::dvec3 centre = cluster.centre_mm, normal = cluster.normal;
  const double trace = m[0][0] + m[1][1] + m[2][2];
  const double xy = m[1][0] + m[0][1], yz = m[2][1] + m[1][2], zx = m[0][2] + m[2][0];
  const double xx = m[0][0], yy = m[1][1], zz = m[2][2];
  std::array<double, Points::size> angle;
  for (std::size_t k = 0; k < Points::size; ++k) {
    const double x = centre.x - points.x[k], y = centre.y - points.y[k], z = centre.z - points.z[k];
    const double by_r2 = 1.0 / (x * x + y * y + z * z), by_r3 = by_r2 * std::sqrt(by_r2);
    const double moments = x * (xx * x + xy * y) + y * (yy * y + yz * z) + z * (zz * z + zx * x);
    angle[k] = by_r3 * (normal.x * x + normal.y * y + normal.z * z + trace - 3.0 * by_r2 * moments);
  }
  for (std::size_t k = 0; k < Points::size; ++k) points.sum[k] += angle[k];
}

}  // namespace

struct WindingTree::Tree {
  /// A leaf holds `count` triangles from `first`; an inner node's children are the next node and node
  /// `first`.
  struct Node : TriangleCluster {
    std::uint32_t first = 0, count = 0;
  };
  std::vector<Corners> triangles;  ///< in the order of the leaves
  std::vector<Node> nodes;

  explicit Tree(const Triangles& surface) {
    const auto count = static_cast<std::uint32_t>(surface.faces.size());
    if (count == 0) return;
    std::vector<Centred> items(count);
    std::vector<Corners> corners(count);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 4096), [&](const auto& range) {
      for (std::uint32_t f = range.begin(); f != range.end(); ++f) {
        for (std::size_t k = 0; k < 3; ++k) corners[f][k] = surface.points_mm[surface.faces[f][k]];
        items[f] = {(corners[f][0] + corners[f][1] + corners[f][2]) / 3.0, f};
      }
    });
    triangles.resize(count);
    nodes.resize(halving_nodes(count, leaf_size));
    halve(
        items, leaf_size,
        [&](std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
          for (std::uint32_t i = begin; i < end; ++i) triangles[i] = corners[items[i].number];
          nodes[self] = {cluster_of(std::span(triangles).subspan(begin, end - begin)), begin, end - begin};
        },
        [&](std::uint32_t self, std::uint32_t second) {
          nodes[self] = {cluster_of(nodes[self + 1], nodes[second]), second, 0};
        },
        0, 0, count);
  }

  /// Points with a ball that contains them.
  struct Packet : Points {
    glm::dvec3 centre_mm{0.0};
    double radius_mm = 0.0;

    /// Entries beyond the last number repeat the first.
    Packet(const std::vector<glm::dvec3>& points_mm, std::span<const std::uint32_t> numbers) {
      glm::dvec3 low = points_mm[numbers.front()], high = low;
      for (std::size_t k = 0; k < size; ++k) {
        const glm::dvec3& p = points_mm[numbers[k < numbers.size() ? k : 0]];
        x[k] = p.x, y[k] = p.y, z[k] = p.z;
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
      centre_mm = 0.5 * (low + high);
      radius_mm = 0.5 * glm::distance(low, high);
    }
  };

  void descend(Packet& packet) const {
    std::array<std::uint32_t, 64> waiting;
    std::size_t top = 0;
    waiting[top++] = 0;
    while (top > 0) {
      const std::uint32_t index = waiting[--top];
      const Node& node = nodes[index];
      const glm::dvec3 r = node.centre_mm - packet.centre_mm;
      const double reach = nearness() * node.radius_mm + packet.radius_mm;
      if (glm::dot(r, r) > reach * reach) {
        add_moments(node, packet);
      } else if (node.count > 0) {
        add_solid_angles(std::span(triangles).subspan(node.first, node.count), packet);
      } else {
        assert(top + 2 <= waiting.size());
        waiting[top++] = node.first;
        waiting[top++] = index + 1;
      }
    }
  }
};

WindingTree::WindingTree(const Triangles& surface) : tree_(std::make_unique<Tree>(surface)) {}
WindingTree::~WindingTree() = default;
WindingTree::WindingTree(WindingTree&&) noexcept = default;
WindingTree& WindingTree::operator=(WindingTree&&) noexcept = default;

std::vector<double> WindingTree::at(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<double> winding(points_mm.size(), 0.0);
  if (tree_->nodes.empty()) return winding;
  const std::vector<std::uint32_t> order = morton_order(points_mm).numbers;
  constexpr std::size_t size = Tree::Packet::size;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, (order.size() + size - 1) / size, 32), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const auto numbers = std::span(order).subspan(i * size, std::min(size, order.size() - i * size));
          Tree::Packet packet(points_mm, numbers);
          tree_->descend(packet);
          for (std::size_t k = 0; k < numbers.size(); ++k)
            winding[numbers[k]] = packet.sum[k] / (4.0 * std::numbers::pi);
        }
      });
  return winding;
}

}  // namespace octotomy::brep
