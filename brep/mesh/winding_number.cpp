// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 halve the triangles at the median centre along the longest axis; 2 sum the moments of each half from its
// own; 3 for eight neighbouring points along a Morton curve, descend where a cluster is within `nearness`
// radii of their ball, else take the moments. Departure from the source: no third order, as only the level of
// a half is looked for.
#include "brep/mesh/winding_number.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brep/mesh/halving.h"
#include "brep/mesh/morton_tree.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t leaf_size = 8;

/// A cluster counts by its moments from this many of its radii on; the source's accuracy scale.
constexpr double nearness() {
  return 2.0;
}

using Corners = std::array<glm::dvec3, 3>;

/// 4 pi times the share of the sphere about p that the triangle covers, positive seen from behind.
double solid_angle(const Corners& triangle, const glm::dvec3& p) {
  const glm::dvec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double below = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
  const double above = glm::dot(a, glm::cross(b, c));
  if (below > 4.0 * std::abs(above)) {  // a small angle: the series, to 1e-7
    const double t = above / below, t2 = t * t;
    return 2.0 * t * (1.0 - t2 * (1.0 / 3.0 - t2 * (1.0 / 5.0 - t2 * (1.0 / 7.0 - t2 / 9.0))));
  }
  return above == 0.0 && below == 0.0 ? 0.0 : 2.0 * std::atan2(above, below);
}

}  // namespace

struct WindingTree::Tree {
  /// A leaf holds `count` triangles from `first`; an inner node's children are the next one and `first`.
  struct Node {
    glm::dvec3 centre_mm{0.0};
    double radius_mm = 0.0;  ///< of a ball about the centre that holds all corners
    double area_mm2 = 0.0;
    glm::dvec3 normal{0.0};  ///< sum of area vectors
    glm::dmat3 moment{0.0};  ///< column j: sum of area vectors times coordinate j of (middle - centre)
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
          nodes[self].first = begin;
          nodes[self].count = end - begin;
          sum_leaf(nodes[self]);
        },
        [&](std::uint32_t self, std::uint32_t second) {
          nodes[self].first = second;
          sum_halves(nodes[self], nodes[self + 1], nodes[second]);
        },
        0, 0, count);
  }

  void sum_leaf(Node& node) const {
    glm::dvec3 middle_sum(0.0), plain_sum(0.0);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Corners& t = triangles[i];
      const glm::dvec3 area = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]), middle = (t[0] + t[1] + t[2]) / 3.0;
      node.area_mm2 += glm::length(area);
      middle_sum += glm::length(area) * middle;
      plain_sum += middle;
      node.normal += area;
    }
    node.centre_mm = node.area_mm2 > 0.0 ? middle_sum / node.area_mm2 : plain_sum / double(node.count);
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Corners& t = triangles[i];
      const glm::dvec3 area = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]), middle = (t[0] + t[1] + t[2]) / 3.0;
      node.moment += glm::outerProduct(area, middle - node.centre_mm);
      for (const glm::dvec3& p : t)
        node.radius_mm = std::max(node.radius_mm, glm::distance(p, node.centre_mm));
    }
  }

  static void sum_halves(Node& node, const Node& a, const Node& b) {
    node.area_mm2 = a.area_mm2 + b.area_mm2;
    node.normal = a.normal + b.normal;
    node.centre_mm = node.area_mm2 > 0.0
                         ? (a.area_mm2 * a.centre_mm + b.area_mm2 * b.centre_mm) / node.area_mm2
                         : 0.5 * (a.centre_mm + b.centre_mm);
    for (const Node* half : {&a, &b}) {
      node.moment += half->moment + glm::outerProduct(half->normal, half->centre_mm - node.centre_mm);
      node.radius_mm =
          std::max(node.radius_mm, half->radius_mm + glm::distance(half->centre_mm, node.centre_mm));
    }
  }

  /// Points near each other, which are answered by one descent.
  struct Packet {
    static constexpr std::size_t size = 8;
    std::array<double, size> x, y, z, sum{};
    glm::dvec3 centre_mm{0.0};
    double radius_mm = 0.0;  ///< of a ball about the centre that holds all

    /// Places beyond the last number repeat the first.
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
    glm::dvec3 at(std::size_t k) const { return {x[k], y[k], z[k]}; }
  };

  /// Adds what a cluster covers of the sphere about each point: the gradient of 1 / r and its derivative, on
  /// the area vectors and their first moment.
  static void add_moments(const Node& node, Packet& packet) {
    const glm::dmat3& m = node.moment;
    const double trace = m[0][0] + m[1][1] + m[2][2];
    const double xy = m[1][0] + m[0][1], yz = m[2][1] + m[1][2], zx = m[0][2] + m[2][0];
    for (std::size_t k = 0; k < Packet::size; ++k) {
      const double x = node.centre_mm.x - packet.x[k], y = node.centre_mm.y - packet.y[k],
                   z = node.centre_mm.z - packet.z[k];
      const double by_r2 = 1.0 / (x * x + y * y + z * z), by_r3 = by_r2 * std::sqrt(by_r2);
      const double moments =
          x * (m[0][0] * x + xy * y) + y * (m[1][1] * y + yz * z) + z * (m[2][2] * z + zx * x);
      packet.sum[k] +=
          by_r3 * (node.normal.x * x + node.normal.y * y + node.normal.z * z + trace - 3.0 * by_r2 * moments);
    }
  }

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
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
          for (std::size_t k = 0; k < Packet::size; ++k)
            packet.sum[k] += solid_angle(triangles[i], packet.at(k));
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
