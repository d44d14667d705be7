// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 keep the triangles that reach into the box both surfaces have in common; 2 sort them along a Morton curve
// and lay a tree of boxes over runs of the order; 3 descend both trees together to pairs of overlapping
// boxes; 4 test those pairs by exact predicates.
#include "brep/mesh/intersecting_triangles.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <utility>

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::size_t leaf_size = 4;

struct Box {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  void add(const Box& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  bool overlaps(const Box& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
           low.z <= other.high.z && other.low.z <= high.z;
  }
};

Box box_of(const Triangles& surface, std::uint32_t face) {
  assert(face < surface.faces.size());
  Box box;
  for (const std::uint32_t v : surface.faces[face]) box.add(surface.points_mm[v]);
  return box;
}

Box box_of(const Triangles& surface) {
  Box box;
  for (const auto& face : surface.faces)
    for (const std::uint32_t v : face) box.add(surface.points_mm[v]);
  return box;
}

/// 20 bits spread to every third.
std::uint64_t spread(std::uint64_t bits) {
  assert(bits < (1u << 20));
  bits = (bits | bits << 32) & 0x001f00000000ffffu;
  bits = (bits | bits << 16) & 0x001f0000ff0000ffu;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
  return (bits | bits << 2) & 0x1249249249249249u;
}

/// Boxes over halves of halves of the order; a node stands for a run of it and is numbered like a heap's.
class MortonTree {
 public:
  MortonTree(const Triangles& surface, const Box& room) {
    std::vector<std::uint8_t> reaches(surface.faces.size(), 0);
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, static_cast<std::uint32_t>(reaches.size()), 4096),
                      [&](const auto& range) {
                        for (std::uint32_t f = range.begin(); f != range.end(); ++f)
                          reaches[f] = box_of(surface, f).overlaps(room);
                      });
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::uint32_t f = 0; f < reaches.size(); ++f)
      if (reaches[f]) order.emplace_back(0, f);
    const glm::dvec3 extent = glm::max(room.high - room.low, glm::dvec3(std::numeric_limits<double>::min()));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const Box box = box_of(surface, order[i].second);
        const glm::dvec3 share =
            glm::clamp((0.5 * (box.low + box.high) - room.low) / extent, glm::dvec3(0.0), glm::dvec3(1.0));
        const glm::dvec3 cell = share * static_cast<double>((1u << 20) - 1);
        order[i].first = spread(static_cast<std::uint64_t>(cell.x)) |
                         spread(static_cast<std::uint64_t>(cell.y)) << 1 |
                         spread(static_cast<std::uint64_t>(cell.z)) << 2;
      }
    });
    tbb::parallel_sort(order.begin(), order.end());
    faces_.resize(order.size());
    boxes_.resize(order.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        faces_[i] = order[i].second;
        boxes_[i] = box_of(surface, faces_[i]);
      }
    });
    if (!faces_.empty()) build({1, 0, faces_.size()});
  }

  struct Node {
    std::size_t number, begin, end;
    bool is_leaf() const { return end - begin <= leaf_size; }
    Node first() const { return {2 * number, begin, begin + (end - begin) / 2}; }
    Node second() const { return {2 * number + 1, begin + (end - begin) / 2, end}; }
  };

  bool empty() const { return faces_.empty(); }
  Node root() const { return {1, 0, faces_.size()}; }
  const Box& box(const Node& node) const {
    assert(node.number < node_boxes_.size());
    return node_boxes_[node.number];
  }
  const Box& box(std::size_t i) const { return boxes_[i]; }
  std::uint32_t face(std::size_t i) const { return faces_[i]; }

 private:
  Box build(const Node& node) {
    assert(node.begin < node.end && node.end <= faces_.size());
    if (node_boxes_.size() <= node.number) node_boxes_.resize(2 * node.number + 2);
    Box box;
    if (node.is_leaf()) {
      for (std::size_t i = node.begin; i < node.end; ++i) box.add(boxes_[i]);
    } else {
      box = build(node.first());
      box.add(build(node.second()));
    }
    return node_boxes_[node.number] = box;
  }

  std::vector<std::uint32_t> faces_;
  std::vector<Box> boxes_;  ///< of the faces, in the order
  std::vector<Box> node_boxes_;
};

/// Appends the pairs of faces whose boxes overlap.
void descend(const MortonTree& a, const MortonTree::Node& of_a, const MortonTree& b,
             const MortonTree::Node& of_b, std::vector<Pair>& pairs) {
  if (!a.box(of_a).overlaps(b.box(of_b))) return;
  if (of_a.is_leaf() && of_b.is_leaf()) {
    for (std::size_t i = of_a.begin; i < of_a.end; ++i)
      for (std::size_t j = of_b.begin; j < of_b.end; ++j)
        if (a.box(i).overlaps(b.box(j))) pairs.emplace_back(a.face(i), b.face(j));
    return;
  }
  if (of_b.is_leaf() || (!of_a.is_leaf() && of_a.end - of_a.begin >= of_b.end - of_b.begin)) {
    descend(a, of_a.first(), b, of_b, pairs);
    descend(a, of_a.second(), b, of_b, pairs);
  } else {
    descend(a, of_a, b, of_b.first(), pairs);
    descend(a, of_a, b, of_b.second(), pairs);
  }
}

Kernel::Triangle_3 exact(const Triangles& surface, std::uint32_t face) {
  const auto point = [&](std::size_t k) {
    const glm::dvec3& p = surface.points_mm[surface.faces[face][k]];
    return Kernel::Point_3(p.x, p.y, p.z);
  };
  return {point(0), point(1), point(2)};
}

std::vector<std::uint32_t> marked(const std::vector<std::uint8_t>& marks) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t f = 0; f < marks.size(); ++f)
    if (marks[f]) numbers.push_back(f);
  return numbers;
}

}  // namespace

IntersectingTriangles intersecting_triangles(const Triangles& a, const Triangles& b) {
  Box room = box_of(a);
  const Box box_b = box_of(b);
  if (!room.overlaps(box_b)) return {};
  room.low = glm::max(room.low, box_b.low);
  room.high = glm::min(room.high, box_b.high);
  const MortonTree of_a(a, room), of_b(b, room);
  if (of_a.empty() || of_b.empty()) return {};
  std::vector<Pair> pairs;
  descend(of_a, of_a.root(), of_b, of_b.root(), pairs);

  std::vector<std::uint8_t> meets(pairs.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pairs.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      assert(pairs[i].first < a.faces.size() && pairs[i].second < b.faces.size());
      const Kernel::Triangle_3 s = exact(a, pairs[i].first), t = exact(b, pairs[i].second);
      meets[i] = s.is_degenerate() || t.is_degenerate() || CGAL::do_intersect(s, t);
    }
  });
  std::vector<std::uint8_t> marks_a(a.faces.size(), 0), marks_b(b.faces.size(), 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!meets[i]) continue;
    marks_a[pairs[i].first] = 1;
    marks_b[pairs[i].second] = 1;
  }
  return {marked(marks_a), marked(marks_b)};
}

}  // namespace octotomy::brep
