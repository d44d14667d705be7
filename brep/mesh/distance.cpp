// SPDX-License-Identifier: AGPL-3.0-or-later
// A binary tree of axis-aligned boxes, split at the median centre along the longest axis. Nearest point of a
// triangle: Ericson, Real-Time Collision Detection, 2005, 5.1.5.
#include "brep/mesh/distance.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "brep/mesh/halving.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/ray_passing.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t leaf_size = 4;
/// A tree is 32 deep at most, along a curve 60 more, and each level leaves one node waiting.
constexpr std::size_t most_waiting = 96;

struct Corners {
  glm::dvec3 a, b, c;
};

struct TreeBox {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  void add(const Corners& t) {
    low = glm::min(low, glm::min(t.a, glm::min(t.b, t.c)));
    high = glm::max(high, glm::max(t.a, glm::max(t.b, t.c)));
  }
  double squared_distance(const glm::dvec3& p) const {
    const glm::dvec3 d = glm::max(glm::max(low - p, p - high), glm::dvec3(0.0));
    return glm::dot(d, d);
  }
};

TreeBox box_of(const Corners& t) {
  return {glm::min(t.a, glm::min(t.b, t.c)), glm::max(t.a, glm::max(t.b, t.c))};
}

/// Square of what rounding may take off a distance: some units in the last place of the largest coordinate.
double squared_rounding(const glm::dvec3& p, const TreeBox& all) {
  const glm::dvec3 most = glm::max(glm::abs(p), glm::max(glm::abs(all.low), glm::abs(all.high)));
  const double rounding = 64.0 * std::numeric_limits<double>::epsilon() * (most.x + most.y + most.z);
  return rounding * rounding;
}

/// A squared distance to a box from which on no triangle in it is computed to be as near as `nearest`: with a
/// rounding of r, (d + r)^2 <= (1 + s) d^2 + (1 + 1 / s) r^2 for any s > 0.
double surely_farther(double nearest, double rounding_mm2) {
  constexpr double share = 1e-6;
  return (1.0 + share) * nearest + (1.0 + 1.0 / share) * rounding_mm2;
}

/// Share of the way from a to b at which a segment is nearest.
double share_along(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  return length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
}

double squared_distance_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = p - (a + share_along(p, a, b) * (b - a));
  return glm::dot(d, d);
}

double squared_distance_to_triangle(const glm::dvec3& p, const Corners& t) {
  const glm::dvec3 ab = t.b - t.a, ac = t.c - t.a, normal = glm::cross(ab, ac);
  const double normal2 = glm::dot(normal, normal);
  if (normal2 > 0.0) {
    // Barycentric coordinates of the foot in the plane; inside, the height is the distance.
    const glm::dvec3 ap = p - t.a;
    const double v = glm::dot(glm::cross(ap, ac), normal), w = glm::dot(glm::cross(ab, ap), normal);
    if (v >= 0.0 && w >= 0.0 && v + w <= normal2) {
      const double height = glm::dot(ap, normal);
      return height * height / normal2;
    }
  }
  return std::min({squared_distance_to_segment(p, t.a, t.b), squared_distance_to_segment(p, t.b, t.c),
                   squared_distance_to_segment(p, t.c, t.a)});
}

/// Barycentric coordinates of the triangle's nearest point, by the cases of squared_distance_to_triangle().
glm::dvec3 nearest_weights(const glm::dvec3& p, const Corners& t) {
  const glm::dvec3 ab = t.b - t.a, ac = t.c - t.a, normal = glm::cross(ab, ac);
  const double normal2 = glm::dot(normal, normal);
  if (normal2 > 0.0) {
    const glm::dvec3 ap = p - t.a;
    const double v = glm::dot(glm::cross(ap, ac), normal), w = glm::dot(glm::cross(ab, ap), normal);
    if (v >= 0.0 && w >= 0.0 && v + w <= normal2)
      return {(normal2 - v - w) / normal2, v / normal2, w / normal2};
  }
  const double sides[] = {squared_distance_to_segment(p, t.a, t.b), squared_distance_to_segment(p, t.b, t.c),
                          squared_distance_to_segment(p, t.c, t.a)};
  const auto side = std::min_element(std::begin(sides), std::end(sides)) - std::begin(sides);
  const glm::dvec3 corners[] = {t.a, t.b, t.c};
  const double share = share_along(p, corners[side], corners[(side + 1) % 3]);
  assert(share >= 0.0 && share <= 1.0);
  glm::dvec3 weights(0.0);
  weights[static_cast<int>(side)] = 1.0 - share;
  weights[static_cast<int>((side + 1) % 3)] = share;
  return weights;
}

}  // namespace

glm::dvec3 nearest_of_triangle(const glm::dvec3& p_mm, const glm::dvec3& a_mm, const glm::dvec3& b_mm,
                               const glm::dvec3& c_mm) {
  const glm::dvec3 weights = nearest_weights(p_mm, {a_mm, b_mm, c_mm});
  return weights.x * a_mm + weights.y * b_mm + weights.z * c_mm;
}

bool is_inside(const glm::dvec3& p_mm, const Triangles& surface) {
  const auto passed = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, surface.faces.size(), 4096), std::size_t{0},
      [&](const auto& range, std::size_t count) {
        for (std::size_t f = range.begin(); f != range.end(); ++f) {
          const auto& face = surface.faces[f];
          count += passing_of(p_mm, surface.points_mm[face[0]], surface.points_mm[face[1]],
                              surface.points_mm[face[2]]) != RayPassing::Beside;
        }
        return count;
      },
      std::plus<>());
  return passed % 2 == 1;
}

struct SurfaceTree::Tree {
  /// A leaf holds `count` triangles from `first`; an inner node's children are the next one and `first`.
  struct Node {
    TreeBox box;
    std::uint32_t first = 0, count = 0;
  };
  std::vector<Corners> triangles;  ///< in the order of the leaves
  std::vector<std::uint32_t> faces;
  std::vector<Node> nodes;

  Tree(const Triangles& source, SurfaceTree::Build build) {
    const auto count = static_cast<std::uint32_t>(source.faces.size());
    if (count == 0) return;
    faces.resize(count);
    std::vector<Corners> unordered(count);
    std::vector<Centred> items(count);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 4096), [&](const auto& range) {
      for (std::uint32_t i = range.begin(); i != range.end(); ++i) {
        const auto& f = source.faces[i];
        assert(std::max({f[0], f[1], f[2]}) < source.points_mm.size());
        unordered[i] = {source.points_mm[f[0]], source.points_mm[f[1]], source.points_mm[f[2]]};
        TreeBox box;
        box.add(unordered[i]);
        items[i] = {0.5 * box.low + 0.5 * box.high, i};
      }
    });
    triangles.resize(count);
    nodes.resize(halving_nodes(count, leaf_size));
    const auto leaf = [&](std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) {
        faces[i] = items[i].number;
        triangles[i] = unordered[faces[i]];
        nodes[self].box.add(triangles[i]);
      }
      nodes[self].first = begin;
      nodes[self].count = end - begin;
    };
    const auto inner = [&](std::uint32_t self, std::uint32_t second) {
      nodes[self].first = second;
      for (const std::uint32_t half : {self + 1, second}) {
        nodes[self].box.low = glm::min(nodes[self].box.low, nodes[half].box.low);
        nodes[self].box.high = glm::max(nodes[self].box.high, nodes[half].box.high);
      }
    };
    if (build == SurfaceTree::Build::Searched) {
      halve(items, leaf_size, leaf, inner, 0, 0, count);
      return;
    }
    std::vector<glm::dvec3> centres_mm(count);
    for (std::uint32_t i = 0; i < count; ++i) centres_mm[i] = items[i].centre_mm;
    const MortonOrder order = morton_order(centres_mm);
    for (std::uint32_t i = 0; i < count; ++i) items[i].number = order.numbers[i];
    nodes.clear();
    const auto build_run = [&](const auto& again, std::uint32_t begin, std::uint32_t end) -> void {
      const auto self = static_cast<std::uint32_t>(nodes.size());
      nodes.emplace_back();
      if (end - begin <= leaf_size) {
        leaf(self, begin, end);
        return;
      }
      const auto middle = static_cast<std::uint32_t>(order.split(begin, end));
      again(again, begin, middle);
      const auto second = static_cast<std::uint32_t>(nodes.size());
      again(again, middle, end);
      inner(self, second);
    };
    build_run(build_run, 0, count);
  }

  void check_not_empty() const {
    if (nodes.empty())
      throw std::invalid_argument(
          "there is no distance to a surface without triangles; ask whether it is empty first");
  }

  /// The least of what squared_distance_to_triangle() says of all triangles, wherever the search starts.
  double distance(const glm::dvec3& p, std::uint32_t& nearest_triangle, double enough_mm = 0.0) const {
    assert(nearest_triangle < triangles.size());
    double nearest = squared_distance_to_triangle(p, triangles[nearest_triangle]);
    const double rounding_mm2 = squared_rounding(p, nodes[0].box);
    std::array<std::pair<std::uint32_t, double>, most_waiting> waiting;
    std::size_t top = 0;
    waiting[top++] = {0, nodes[0].box.squared_distance(p)};
    while (top > 0 && nearest >= enough_mm * enough_mm) {
      const auto [index, bound] = waiting[--top];
      if (bound > surely_farther(nearest, rounding_mm2)) continue;
      const Node& node = nodes[index];
      if (node.count > 0) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          if (box_of(triangles[i]).squared_distance(p) > surely_farther(nearest, rounding_mm2)) continue;
          const double squared = squared_distance_to_triangle(p, triangles[i]);
          if (squared >= nearest) continue;
          nearest = squared;
          nearest_triangle = i;
        }
        continue;
      }
      std::pair<std::uint32_t, double> near{index + 1, nodes[index + 1].box.squared_distance(p)};
      std::pair<std::uint32_t, double> far{node.first, nodes[node.first].box.squared_distance(p)};
      if (far.second < near.second) std::swap(near, far);
      assert(top + 2 <= waiting.size());
      waiting[top++] = far;
      waiting[top++] = near;
    }
    return std::sqrt(nearest);
  }

  /// Calls found(i, distance, triangle) for each point, in parallel.
  template <typename Found>
  void search(const std::vector<glm::dvec3>& points_mm, const Found& found) const {
    check_not_empty();
    // Blocks are fixed, so that where each search starts does not depend on the threads.
    constexpr std::size_t block = 256;
    tbb::parallel_for(std::size_t{0}, (points_mm.size() + block - 1) / block, [&](std::size_t b) {
      std::uint32_t triangle = 0;
      for (std::size_t i = b * block; i < std::min((b + 1) * block, points_mm.size()); ++i) {
        const double distance_mm = distance(points_mm[i], triangle);
        found(i, distance_mm, triangle);
      }
    });
  }

  template <typename Visit>
  void visit_crossings(const glm::dvec3& p, Visit visit) const {
    if (nodes.empty()) return;
    std::array<std::uint32_t, most_waiting> waiting;
    std::size_t top = 0;
    waiting[top++] = 0;
    while (top > 0) {
      const std::uint32_t index = waiting[--top];
      const Node& node = nodes[index];
      if (node.box.high.x < p.x || node.box.low.y > p.y || node.box.high.y < p.y || node.box.low.z > p.z ||
          node.box.high.z < p.z)
        continue;
      if (node.count == 0) {
        assert(top + 2 <= waiting.size());
        waiting[top++] = node.first;
        waiting[top++] = index + 1;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
        if (const Corners& t = triangles[i]; passing_of(p, t.a, t.b, t.c) != RayPassing::Beside) visit(i);
    }
  }
};

SurfaceTree::SurfaceTree(const Triangles& triangles) : SurfaceTree(triangles, Build::Searched) {}
SurfaceTree::SurfaceTree(const Triangles& triangles, Build build)
    : tree_(std::make_unique<Tree>(triangles, build)) {}
SurfaceTree::SurfaceTree(const Mesh& mesh) : SurfaceTree(triangles_of(mesh)) {}
SurfaceTree::~SurfaceTree() = default;
SurfaceTree::SurfaceTree(SurfaceTree&&) noexcept = default;
SurfaceTree& SurfaceTree::operator=(SurfaceTree&&) noexcept = default;

std::vector<double> SurfaceTree::distances_mm(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<double> distances(points_mm.size());
  tree_->search(points_mm, [&](std::size_t i, double distance, std::uint32_t) { distances[i] = distance; });
  return distances;
}

double SurfaceTree::distance_mm(const glm::dvec3& p_mm, std::uint32_t& triangle, double enough_mm) const {
  tree_->check_not_empty();
  return tree_->distance(p_mm, triangle, enough_mm);
}

std::vector<Foot> SurfaceTree::feet(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<Foot> feet(points_mm.size());
  tree_->search(points_mm, [&](std::size_t i, double distance, std::uint32_t triangle) {
    const Corners& t = tree_->triangles[triangle];
    const glm::dvec3 weights = nearest_weights(points_mm[i], t);
    feet[i] = {weights.x * t.a + weights.y * t.b + weights.z * t.c, distance, tree_->faces[triangle],
               weights};
  });
  return feet;
}

std::vector<std::uint8_t> SurfaceTree::inside(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<std::uint8_t> inside(points_mm.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_mm.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      tree_->visit_crossings(points_mm[i], [&](std::uint32_t) { inside[i] ^= 1u; });
  });
  return inside;
}

std::vector<Crossing> SurfaceTree::crossings(const glm::dvec3& p_mm) const {
  std::vector<Crossing> crossings;
  tree_->visit_crossings(p_mm, [&](std::uint32_t i) {
    const Corners& t = tree_->triangles[i];
    crossings.push_back({tree_->faces[i], glm::cross(t.b - t.a, t.c - t.a).x > 0.0});
  });
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.face < b.face; });
  return crossings;
}

}  // namespace octotomy::brep
