// SPDX-License-Identifier: AGPL-3.0-or-later
// A tree of axis-aligned boxes, split at the median centre along the longest axis. Two levels of halves form
// one node of four boxes (four_boxes.h). Nearest point of a triangle: Ericson, Real-Time Collision Detection,
// 2005, 5.1.5.
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

#include "brep/mesh/error.h"
#include "brep/mesh/for_vectors.h"
#include "brep/mesh/four_boxes.h"
#include "brep/mesh/halving.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/ray_passing.h"
#include "brep/mesh/segment.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t leaf_size = 4;
/// Halving makes at most 32 levels; splitting along a curve makes up to 60 more. A node combines two levels
/// and leaves at most three of its children on the stack.
constexpr std::size_t most_waiting = 3 * 46 + 4;

struct Corners {
  glm::dvec3 a, b, c;
};

TreeBox box_of(const Corners& t) {
  return {glm::min(t.a, glm::min(t.b, t.c)), glm::max(t.a, glm::max(t.b, t.c))};
}

/// Bound on the rounding error of distances to boxes and triangles. Floats are accurate to 2^-24. Along each
/// axis two values are rounded: the point's offset from the middle of all boxes, and its offset from the box.
/// The latter is at most the sum of the offsets of point and box from the middle. 2^-20 of the longest of
/// these lengths is five times the error. Distances to triangles use doubles, accurate to 2^-53, relative to
/// the origin: 2^-44 of the largest coordinates covers their products.
double rounding_mm(const glm::dvec3& p, const TreeBox& all, const glm::dvec3& middle) {
  const glm::dvec3 ways = glm::max(glm::abs(p - middle), all.high - middle);
  const glm::dvec3 most = glm::max(glm::abs(p), glm::max(glm::abs(all.low), glm::abs(all.high)));
  return 0x1p-20 * (ways.x + ways.y + ways.z) + 0x1p-44 * (most.x + most.y + most.z);
}

/// A float bound: if the squared distance to a box exceeds it, no triangle in the box can be computed to be
/// as near as `nearest`. The added share exceeds five roundings of squares and sums.
float surely_farther(double nearest, double rounding_mm) {
  const double mm = std::sqrt(nearest) + rounding_mm;
  return static_cast<float>(mm * mm * (1.0 + 0x1p-20));
}

/// Four triangles for one vector operation: coordinates by corner, axis and triangle.
struct FourTriangles {
  double corner[3][3][4];

  void put(std::size_t lane, const Corners& t) {
    for (int axis = 0; axis < 3; ++axis) {
      corner[0][axis][lane] = t.a[axis];
      corner[1][axis][lane] = t.b[axis];
      corner[2][axis][lane] = t.c[axis];
    }
  }
  Corners at(std::size_t lane) const {
    const auto point = [&](const double(&axes)[3][4]) {
      return glm::dvec3(axes[0][lane], axes[1][lane], axes[2][lane]);
    };
    return {point(corner[0]), point(corner[1]), point(corner[2])};
  }
};

/// Squared distances from a point to each triangle. If the point is above the triangle (by the barycentric
/// coordinates of its foot in the plane), the distance is the height; otherwise it is that to the nearest
/// side.
OCTOTOMY_FOR_VECTORS void squared_distances(const FourTriangles& four, double px, double py, double pz,
                                            double* squared) {
  for (int i = 0; i < 4; ++i) {
    const double ax = four.corner[0][0][i], ay = four.corner[0][1][i], az = four.corner[0][2][i];
    const double bx = four.corner[1][0][i], by = four.corner[1][1][i], bz = four.corner[1][2][i];
    const double cx = four.corner[2][0][i], cy = four.corner[2][1][i], cz = four.corner[2][2][i];
    // Sides a b, b c and c a; the cross products use a c.
    const double ux = bx - ax, uy = by - ay, uz = bz - az, vx = cx - bx, vy = cy - by, vz = cz - bz,
                 wx = ax - cx, wy = ay - cy, wz = az - cz, ex = cx - ax, ey = cy - ay, ez = cz - az;
    const double nx = uy * ez - ey * uz, ny = uz * ex - ez * ux, nz = ux * ey - ex * uy;
    const double normal2 = nx * nx + ny * ny + nz * nz;
    const double qx = px - ax, qy = py - ay, qz = pz - az;
    const double v = (qy * ez - ey * qz) * nx + (qz * ex - ez * qx) * ny + (qx * ey - ex * qy) * nz;
    const double w = (uy * qz - qy * uz) * nx + (uz * qx - qz * ux) * ny + (ux * qy - qx * uy) * nz;
    const double height = qx * nx + qy * ny + qz * nz;
    const double above = height * height / normal2;

    const double rx = px - bx, ry = py - by, rz = pz - bz, sx = px - cx, sy = py - cy, sz = pz - cz;
    const double u2 = ux * ux + uy * uy + uz * uz, v2 = vx * vx + vy * vy + vz * vz,
                 w2 = wx * wx + wy * wy + wz * wz;
    double along_u = (qx * ux + qy * uy + qz * uz) / u2, along_v = (rx * vx + ry * vy + rz * vz) / v2,
           along_w = (sx * wx + sy * wy + sz * wz) / w2;
    along_u = along_u < 0.0 ? 0.0 : 1.0 < along_u ? 1.0 : along_u;
    along_v = along_v < 0.0 ? 0.0 : 1.0 < along_v ? 1.0 : along_v;
    along_w = along_w < 0.0 ? 0.0 : 1.0 < along_w ? 1.0 : along_w;
    along_u = u2 > 0.0 ? along_u : 0.0;
    along_v = v2 > 0.0 ? along_v : 0.0;
    along_w = w2 > 0.0 ? along_w : 0.0;
    const double ux_off = px - (ax + along_u * ux), uy_off = py - (ay + along_u * uy),
                 uz_off = pz - (az + along_u * uz);
    const double vx_off = px - (bx + along_v * vx), vy_off = py - (by + along_v * vy),
                 vz_off = pz - (bz + along_v * vz);
    const double wx_off = px - (cx + along_w * wx), wy_off = py - (cy + along_w * wy),
                 wz_off = pz - (cz + along_w * wz);
    const double to_u = ux_off * ux_off + uy_off * uy_off + uz_off * uz_off,
                 to_v = vx_off * vx_off + vy_off * vy_off + vz_off * vz_off,
                 to_w = wx_off * wx_off + wy_off * wy_off + wz_off * wz_off;
    double beside = to_v < to_u ? to_v : to_u;
    beside = to_w < beside ? to_w : beside;
    // Combines conditions as bits, because branches would prevent vectorisation.
    const bool inside = (normal2 > 0.0) & (v >= 0.0) & (w >= 0.0) & (v + w <= normal2);
    squared[i] = inside ? above : beside;
  }
}

/// Barycentric coordinates of the triangle's nearest point, by the cases of squared_distances().
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

double squared_distance_to_segment(const glm::dvec3& p_mm, const glm::dvec3& a_mm, const glm::dvec3& b_mm) {
  const glm::dvec3 d = p_mm - (a_mm + share_along(p_mm, a_mm, b_mm) * (b_mm - a_mm));
  return glm::dot(d, d);
}

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
  /// A leaf holds `count` triangles from `first`; an inner node's children are the next node and node
  /// `first`.
  struct Node {
    TreeBox box;
    std::uint32_t first = 0, count = 0;
  };
  std::vector<FourTriangles> triangles;  ///< in the order of the leaves; a triangle's index here is its
                                         ///< number in the tree
  std::vector<std::uint32_t> faces;
  std::vector<Node> nodes;
  std::vector<FourBoxes> wide;  ///< two levels of nodes each; the first is the root
  glm::dvec3 middle{0.0};  ///< middle of all boxes: floats are relative to it, so that a position far from
                           ///< the origin loses no digits
  bool is_halved;          ///< nodes were split at the median centre
  std::vector<FourBoxes> boxes_of_leaf;    ///< boxes of each leaf's triangles; for segments only
  std::vector<std::uint32_t> leaf_number;  ///< by node: if it is a leaf, its index in boxes_of_leaf; for
                                           ///< segments only

  Tree(const Triangles& source, SurfaceTree::Build build) : is_halved(build != SurfaceTree::Build::Hasty) {
    const auto count = static_cast<std::uint32_t>(source.faces.size());
    if (count == 0) return;
    std::vector<Centred> items(count);
    const auto corners_of = [&](std::uint32_t face) -> Corners {
      const auto& f = source.faces[face];
      assert(std::max({f[0], f[1], f[2]}) < source.points_mm.size());
      return {source.points_mm[f[0]], source.points_mm[f[1]], source.points_mm[f[2]]};
    };
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 4096), [&](const auto& range) {
      for (std::uint32_t i = range.begin(); i != range.end(); ++i) {
        const TreeBox box = box_of(corners_of(i));
        items[i] = {0.5 * box.low + 0.5 * box.high, i};
      }
    });
    faces.resize(count);
    triangles.resize((count + 3) / 4);
    nodes.resize(halving_nodes(count, leaf_size));
    const auto leaf = [&](std::uint32_t self, std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t i = begin; i < end; ++i) {
        faces[i] = items[i].number;
        const Corners t = corners_of(faces[i]);
        triangles[i / 4].put(i % 4, t);
        nodes[self].box.add(box_of(t));
      }
      nodes[self].first = begin;
      nodes[self].count = end - begin;
    };
    const auto inner = [&](std::uint32_t self, std::uint32_t second) {
      nodes[self].first = second;
      for (const std::uint32_t half : {self + 1, second}) nodes[self].box.add(nodes[half].box);
    };
    if (is_halved)
      halve(items, leaf_size, leaf, inner, 0, 0, count);
    else
      halve_along_curve(items, leaf, inner);
    for (std::uint32_t i = count; i < 4 * triangles.size(); ++i)
      triangles.back().put(i % 4, triangle(count - 1));
    widen();
    if (build == SurfaceTree::Build::ForSegments) add_boxes_of_leaves();
  }

  Corners triangle(std::uint32_t number) const { return triangles[number / 4].at(number % 4); }

  void check_not_empty() const {
    if (nodes.empty())
      throw InvalidInput(
          "there is no distance to a surface without triangles; check whether it is empty first");
  }

  /// The least distance of all triangles, independent of the triangle at which the search starts. Among
  /// equally near triangles, returns the start or, if it is not one of them, the first in the order of a
  /// search through the halves.
  double distance(const glm::dvec3& p, std::uint32_t& nearest_triangle, double enough_mm = 0.0) const {
    assert(nearest_triangle < faces.size());
    const std::uint32_t start = nearest_triangle;
    double nearest = std::numeric_limits<double>::infinity();
    const double rounding = rounding_mm(p, nodes[0].box, middle);
    float farther = std::numeric_limits<float>::infinity();
    const auto look_at = [&](std::uint32_t four, std::uint32_t begin, std::uint32_t end) {
      std::array<double, 4> squared;
      squared_distances(triangles[four], p.x, p.y, p.z, squared.data());
      for (std::uint32_t i = std::max(begin, 4 * four); i < std::min(end, 4 * four + 4); ++i) {
        const double own = squared[i % 4];
        if (!(own < nearest || (own == nearest && comes_before(p, i, nearest_triangle, start)))) continue;
        nearest = own;
        nearest_triangle = i;
        farther = surely_farther(nearest, rounding);
      }
    };
    look_at(start / 4, start, start + 1);
    const ThreeLanes at = lanes_of(glm::vec3(p - middle));
    struct Waiting {
      float bound;
      std::uint32_t child;
    };
    std::array<Waiting, most_waiting> waiting;
    std::size_t top = 0;
    waiting[top++] = {0.0f, 0};
    while (top > 0 && nearest >= enough_mm * enough_mm) {
      const auto [bound, child] = waiting[--top];
      if (bound > farther) continue;
      if (child >= first_leaf) {
        const auto [first, end] = triangles_of_leaf(child - first_leaf);
        for (std::uint32_t four = first / 4; 4 * four < end; ++four) look_at(four, first, end);
        continue;
      }
      // Pushes the nearest of the four last, so that it is visited next.
      const FourBoxes& node = wide[child];
      const Lanes bounds = node.squared_distances(at);
      assert(top + 4 <= waiting.size());
      const std::size_t first = top;
      for (int lane = 0; lane < node.count; ++lane) {
        if (bounds[lane] > farther) continue;
        std::size_t to = top++;
        for (; to > first && waiting[to - 1].bound < bounds[lane]; --to) waiting[to] = waiting[to - 1];
        waiting[to] = {bounds[lane], node.child[static_cast<std::size_t>(lane)]};
      }
    }
    return std::sqrt(nearest);
  }

  /// Calls found(i, distance, triangle) for each point, in parallel.
  template <typename Found>
  void search(const std::vector<glm::dvec3>& points_mm, const Found& found) const {
    check_not_empty();
    // Blocks are fixed, so that the start of each search does not depend on the threads.
    constexpr std::size_t block = 256;
    tbb::parallel_for(std::size_t{0}, (points_mm.size() + block - 1) / block, [&](std::size_t b) {
      std::uint32_t triangle = 0;
      for (std::size_t i = b * block; i < std::min((b + 1) * block, points_mm.size()); ++i) {
        const double distance_mm = distance(points_mm[i], triangle);
        found(i, distance_mm, triangle);
      }
    });
  }

  Foot foot_on(std::uint32_t number, const glm::dvec3& p, double distance_mm) const {
    const Corners t = triangle(number);
    const glm::dvec3 weights = nearest_weights(p, t);
    return {weights.x * t.a + weights.y * t.b + weights.z * t.c, distance_mm, faces[number], weights};
  }

  /// The side of a triangle on which a point lies: -1 inside, 1 outside; 0 where the point's foot is not
  /// clearly within the triangle, so that the triangle alone does not decide. Clearly means by more than
  /// 2^-30 of the largest coordinates, which is far above rounding. The segment to the foot meets no other
  /// triangle, because this triangle is the nearest.
  int side_of(std::uint32_t number, const glm::dvec3& p) const {
    const Corners t = triangle(number);
    const glm::dvec3 most =
        glm::max(glm::abs(p), glm::max(glm::abs(nodes[0].box.low), glm::abs(nodes[0].box.high)));
    const double clear_mm = 0x1p-30 * (most.x + most.y + most.z);
    const glm::dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    const double length = glm::length(normal), height = glm::dot(normal, p - t.a);
    if (!(std::abs(height) > clear_mm * length)) return 0;
    for (const auto& [from, to] : {std::pair(t.a, t.b), std::pair(t.b, t.c), std::pair(t.c, t.a)}) {
      const glm::dvec3 side = to - from;
      // Twice the area between the side and the foot, from the side inwards, times the normal's length.
      if (!(glm::dot(glm::cross(side, p - from), normal) > clear_mm * length * glm::length(side))) return 0;
    }
    return height > 0.0 ? 1 : -1;
  }

  template <typename Meets>
  bool any_along(const glm::dvec3& from, const glm::dvec3& to, const Meets& meets) const {
    if (nodes.empty()) return false;
    assert(!boxes_of_leaf.empty());
    const FlatSegment segment(from - middle, to - middle, nodes[0].box.high - middle);
    if (segment.is_empty) return false;
    std::array<std::uint32_t, most_waiting> waiting;
    std::size_t top = 0;
    waiting[top++] = 0;
    while (top > 0) {
      const std::uint32_t child = waiting[--top];
      const bool is_leaf = child >= first_leaf;
      const FourBoxes& node = is_leaf ? boxes_of_leaf[leaf_number[child - first_leaf]] : wide[child];
      assert(top + 4 <= waiting.size());
      const auto met = node.met(segment);
      // Pushes the first child last, so that it is visited next.
      for (int lane = node.count - 1; lane >= 0; --lane) {
        if (met[lane] == 0) continue;
        const std::uint32_t number = node.child[static_cast<std::size_t>(lane)];
        if (!is_leaf)
          waiting[top++] = number;
        else if (meets(faces[number]))
          return true;
      }
    }
    return false;
  }

  template <typename Visit>
  void visit_crossings(const glm::dvec3& p, Visit visit) const {
    if (nodes.empty()) return;
    // Subtracting the middle preserves the order of coordinates, because rounding is monotonic.
    const glm::vec3 low = rounded_down(p - middle), high = rounded_up(p - middle);
    std::array<std::uint32_t, most_waiting> waiting;
    std::size_t top = 0;
    waiting[top++] = 0;
    while (top > 0) {
      const std::uint32_t child = waiting[--top];
      if (child >= first_leaf) {
        const auto [first, end] = triangles_of_leaf(child - first_leaf);
        for (std::uint32_t i = first; i < end; ++i)
          if (const Corners t = triangle(i); passing_of(p, t.a, t.b, t.c) != RayPassing::Beside) visit(i);
        continue;
      }
      const FourBoxes& node = wide[child];
      assert(top + 4 <= waiting.size());
      const auto passed = node.passed(low, high);
      for (int lane = 0; lane < node.count; ++lane)
        if (passed[lane] != 0) waiting[top++] = node.child[static_cast<std::size_t>(lane)];
    }
  }

 private:
  /// Builds leaves and inner nodes by splitting the triangles along a curve.
  template <typename Leaf, typename Inner>
  void halve_along_curve(std::vector<Centred>& items, const Leaf& leaf, const Inner& inner) {
    std::vector<glm::dvec3> centres_mm(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) centres_mm[i] = items[i].centre_mm;
    const MortonOrder order = morton_order(centres_mm);
    for (std::size_t i = 0; i < items.size(); ++i) items[i].number = order.numbers[i];
    nodes.clear();
    const auto build_run = [&](const auto& again, std::uint32_t begin, std::uint32_t end) -> void {
      const auto self = static_cast<std::uint32_t>(nodes.size());
      nodes.emplace_back();
      if (end - begin <= leaf_size) {
        leaf(self, begin, end);
        return;
      }
      const auto parting = static_cast<std::uint32_t>(order.split(begin, end));
      again(again, begin, parting);
      const auto second = static_cast<std::uint32_t>(nodes.size());
      again(again, parting, end);
      inner(self, second);
    };
    build_run(build_run, 0, static_cast<std::uint32_t>(items.size()));
  }

  /// Makes wide nodes from the inner nodes of every second level, and from a root that is a leaf.
  void widen() {
    std::vector<std::uint8_t> is_even(nodes.size(), 1);
    std::vector<std::uint32_t> own, number(nodes.size(), 0);
    for (std::uint32_t n = 0; n < nodes.size(); ++n) {
      if (nodes[n].count == 0) is_even[n + 1] = is_even[nodes[n].first] = is_even[n] ^ 1;
      if (n > 0 && (nodes[n].count > 0 || is_even[n] == 0)) continue;
      number[n] = static_cast<std::uint32_t>(own.size());
      own.push_back(n);
    }
    middle = 0.5 * nodes[0].box.low + 0.5 * nodes[0].box.high;
    wide.resize(own.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, own.size(), 1024), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const auto add = [&](std::uint32_t n) {
          wide[i].add({nodes[n].box.low - middle, nodes[n].box.high - middle},
                      nodes[n].count > 0 ? first_leaf + n : number[n]);
        };
        const auto add_children = [&](std::uint32_t n) {
          if (nodes[n].count > 0) return add(n);
          add(n + 1);
          add(nodes[n].first);
        };
        if (nodes[own[i]].count > 0) return add(own[i]);
        add_children(own[i] + 1);
        add_children(nodes[own[i]].first);
      }
    });
  }

  void add_boxes_of_leaves() {
    leaf_number.resize(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (nodes[n].count == 0) continue;
      leaf_number[n] = static_cast<std::uint32_t>(boxes_of_leaf.size());
      FourBoxes& boxes = boxes_of_leaf.emplace_back();
      for (std::uint32_t i = nodes[n].first; i < nodes[n].first + nodes[n].count; ++i) {
        const TreeBox box = box_of(triangle(i));
        boxes.add({box.low - middle, box.high - middle}, i);
      }
    }
  }

  std::pair<std::uint32_t, std::uint32_t> triangles_of_leaf(std::uint32_t node) const {
    return {nodes[node].first, nodes[node].first + nodes[node].count};
  }

  /// Whether triangle a precedes b if both are equally near. The start precedes all; otherwise the order is
  /// that of a search that visits the nearer half first.
  bool comes_before(const glm::dvec3& p, std::uint32_t a, std::uint32_t b, std::uint32_t start) const {
    if (b == start || !is_halved) return false;
    std::uint32_t node = 0, begin = 0, end = static_cast<std::uint32_t>(faces.size());
    while (nodes[node].count == 0) {
      const std::uint32_t half = begin + (end - begin) / 2, second = nodes[node].first;
      if ((a < half) != (b < half)) {
        const bool second_first =
            nodes[second].box.squared_distance(p) < nodes[node + 1].box.squared_distance(p);
        return (a < half) != second_first;
      }
      (a < half ? end : begin) = half;
      node = a < half ? node + 1 : second;
    }
    return a < b;
  }
};

SurfaceTree::SurfaceTree(const Triangles& triangles) : SurfaceTree(triangles, Build::Searched) {}
SurfaceTree::SurfaceTree(const Triangles& triangles, Build build)
    : tree_(std::make_unique<Tree>(triangles, build)) {}
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

Foot SurfaceTree::foot(const glm::dvec3& p_mm, std::uint32_t& triangle, double enough_mm) const {
  tree_->check_not_empty();
  const double distance_mm = tree_->distance(p_mm, triangle, enough_mm);
  return tree_->foot_on(triangle, p_mm, distance_mm);
}

std::vector<Foot> SurfaceTree::feet(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<Foot> feet(points_mm.size());
  visit_feet(points_mm, [&](std::size_t i, const Foot& foot) { feet[i] = foot; });
  return feet;
}

void SurfaceTree::visit_feet(const std::vector<glm::dvec3>& points_mm,
                             const std::function<void(std::size_t point, const Foot& foot)>& visit) const {
  tree_->search(points_mm, [&](std::size_t i, double distance, std::uint32_t triangle) {
    visit(i, tree_->foot_on(triangle, points_mm[i], distance));
  });
}

std::vector<double> SurfaceTree::signed_distances_mm(const std::vector<glm::dvec3>& points_mm,
                                                     std::vector<std::uint32_t>& nearest) const {
  assert(nearest.size() == points_mm.size());
  std::vector<double> distances(points_mm.size());
  if (points_mm.empty()) return distances;
  tree_->check_not_empty();
  // Blocks are fixed, so that the start of each search does not depend on the threads.
  constexpr std::size_t block = 256;
  // The ball about a point whose radius is the distance to the surface contains no surface, so that points
  // with overlapping balls lie on the same side. The margin is far above the rounding of distances.
  constexpr double surely = 1.0 - 1e-9;
  tbb::parallel_for(std::size_t{0}, (points_mm.size() + block - 1) / block, [&](std::size_t b) {
    std::uint32_t triangle = 0;
    double before_mm = 0.0;
    for (std::size_t i = b * block; i < std::min((b + 1) * block, points_mm.size()); ++i) {
      if (nearest[i] != unknown_triangle) triangle = nearest[i];
      distances[i] = tree_->distance(points_mm[i], triangle);
      nearest[i] = triangle;
      const int side = tree_->side_of(triangle, points_mm[i]);
      const bool is_as_before = i > b * block && glm::distance(points_mm[i], points_mm[i - 1]) <
                                                     surely * (distances[i] + std::abs(before_mm));
      if (side < 0 || (side == 0 && (is_as_before ? before_mm < 0.0 : is_inside(points_mm[i]))))
        distances[i] = -distances[i];
      before_mm = distances[i];
    }
  });
  return distances;
}

std::vector<std::uint8_t> SurfaceTree::inside(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<std::uint8_t> inside(points_mm.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_mm.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      tree_->visit_crossings(points_mm[i], [&](std::uint32_t) { inside[i] ^= 1u; });
  });
  return inside;
}

bool SurfaceTree::is_inside(const glm::dvec3& p_mm) const {
  bool inside = false;
  tree_->visit_crossings(p_mm, [&](std::uint32_t) { inside = !inside; });
  return inside;
}

bool SurfaceTree::meets_any(const glm::dvec3& from_mm, const glm::dvec3& to_mm,
                            const std::function<bool(std::uint32_t face)>& meets) const {
  return tree_->any_along(from_mm, to_mm, meets);
}

std::vector<Crossing> SurfaceTree::crossings(const glm::dvec3& p_mm) const {
  std::vector<Crossing> crossings;
  tree_->visit_crossings(p_mm, [&](std::uint32_t i) {
    const Corners t = tree_->triangle(i);
    crossings.push_back({tree_->faces[i], glm::cross(t.b - t.a, t.c - t.a).x > 0.0});
  });
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.face < b.face; });
  return crossings;
}

}  // namespace octotomy::brep
