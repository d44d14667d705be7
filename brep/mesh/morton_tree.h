// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <tbb/parallel_invoke.h>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// An axis-aligned box in single precision, rounded outward: half the memory of doubles, and no overlap is
/// missed.
struct OuterBox {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};
  void add(const glm::dvec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto rounded = static_cast<float>(p[axis]);
      low[axis] = std::min(low[axis], rounded > p[axis] ? -next_above(-rounded) : rounded);
      high[axis] = std::max(high[axis], rounded < p[axis] ? next_above(rounded) : rounded);
    }
  }
  void add(const OuterBox& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  bool overlaps(const OuterBox& other) const {
    // A single branch, because six would often be mispredicted.
    return ((low.x <= other.high.x) & (other.low.x <= high.x) & (low.y <= other.high.y) &
            (other.low.y <= high.y) & (low.z <= other.high.z) & (other.low.z <= high.z)) != 0;
  }
  /// The squared distance of the boxes' nearest points.
  double squared_distance(const OuterBox& other) const {
    const glm::dvec3 apart =
        glm::max(glm::max(glm::dvec3(low) - glm::dvec3(other.high), glm::dvec3(other.low) - glm::dvec3(high)),
                 glm::dvec3(0.0));
    return glm::dot(apart, apart);
  }

 private:
  /// std::nextafter() towards infinity for values below infinity, without a function call.
  static float next_above(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);  // 0 for -0
    return std::bit_cast<float>((bits >> 31) == 0 ? bits + 1 : bits - 1);
  }
};

/// Points in the order of a Morton curve through their box; points of one cell in order of number.
struct MortonOrder {
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint64_t> cells;  ///< Morton codes, ascending; 20 bits an axis, x in the lowest bit

  /// The position at which a run of two or more items is split: at the face of the largest cube that divides
  /// the run, or in the run's middle if all points are in one cell. Cost: log n.
  std::size_t split(std::size_t begin, std::size_t end) const;
};

/// Precondition: all points are finite. The result is the same on any number of threads. Cost: linear.
MortonOrder morton_order(const std::vector<glm::dvec3>& points_mm);

/// A tree of boxes over triangles along a Morton curve; each node represents a run of the order. Building:
/// linear; 28 bytes per triangle and about 36 for the nodes. Source: Lauterbach et al., "Fast BVH
/// construction on GPUs", 2009.
class MortonTree {
 public:
  /// A tree over all triangles, or over some. Precondition: their points are finite.
  explicit MortonTree(const Triangles& surface);
  MortonTree(const Triangles& surface, const std::vector<std::uint32_t>& faces);

  bool empty() const { return faces_.empty(); }

  /// Calls visit_face(face) for each face for which `reaches` is true for its box and for the boxes of its
  /// nodes.
  template <typename Reaches, typename Visit>
  void visit(const Reaches& reaches, const Visit& visit_face) const {
    if (!empty()) visit_node(0, reaches, visit_face);
  }

  /// Calls visit(face, other) once for each pair of faces of this tree whose boxes overlap, in parallel.
  template <typename Visit>
  void visit_own_pairs(const Visit& visit_pair) const {
    if (!empty()) within(0, visit_pair);
  }

  /// Calls visit(face of this, face of the other) for each pair whose boxes overlap, in parallel.
  template <typename Visit>
  void visit_pairs(const MortonTree& other, const Visit& visit_pair) const {
    if (!empty() && !other.empty()) between(0, other, 0, visit_pair);
  }

  /// Calls visit_pair(face of this, face of the other) for each pair whose boxes are within `limit_mm2()`, a
  /// squared distance that may decrease during the search. Nearer pairs tend to come first. Not parallel.
  template <typename Limit, typename Visit>
  void visit_near_pairs(const MortonTree& other, const Limit& limit_mm2, const Visit& visit_pair) const {
    if (!empty() && !other.empty()) near(0, other, 0, limit_mm2, visit_pair);
  }

 private:
  static constexpr std::uint32_t leaf_size = 4;
  static constexpr std::uint32_t parallel_size = 4096;

  /// A run of the order; an inner node's children are the next node and node `second`.
  struct Node {
    OuterBox box;
    std::uint32_t begin = 0, end = 0, second = 0;
    std::uint32_t count() const { return end - begin; }
    bool is_leaf() const { return second == 0; }
  };
  /// Builds nodes over the faces and their boxes, which are in Morton order.
  void build(const MortonOrder& order);
  /// Appends the nodes of a run, its own node first; children have their indices in the list.
  void append(const MortonOrder& order, std::uint32_t begin, std::uint32_t end,
              std::vector<Node>& nodes) const;

  template <typename Reaches, typename Visit>
  void visit_node(std::uint32_t number, const Reaches& reaches, const Visit& visit_face) const {
    const Node& node = nodes_[number];
    if (!reaches(node.box)) return;
    if (!node.is_leaf()) {
      visit_node(number + 1, reaches, visit_face);
      visit_node(node.second, reaches, visit_face);
      return;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (reaches(boxes_[i])) visit_face(faces_[i]);
  }

  template <typename Visit>
  void within(std::uint32_t number, const Visit& visit_pair) const {
    const Node& node = nodes_[number];
    if (node.is_leaf()) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        for (std::uint32_t j = i + 1; j < node.end; ++j)
          if (boxes_[i].overlaps(boxes_[j])) visit_pair(faces_[i], faces_[j]);
      return;
    }
    const auto first = [&] { within(number + 1, visit_pair); };
    const auto second = [&] { within(node.second, visit_pair); };
    const auto both = [&] { between(number + 1, *this, node.second, visit_pair); };
    if (node.count() > parallel_size) {
      tbb::parallel_invoke(first, second, both);
    } else {
      first();
      second();
      both();
    }
  }

  template <typename Visit>
  void between(std::uint32_t number, const MortonTree& other, std::uint32_t other_number,
               const Visit& visit_pair) const {
    const Node &own = nodes_[number], &of_other = other.nodes_[other_number];
    if (!own.box.overlaps(of_other.box)) return;
    if (own.is_leaf() && of_other.is_leaf()) {
      for (std::uint32_t i = own.begin; i < own.end; ++i) {
        if (!boxes_[i].overlaps(of_other.box)) continue;
        for (std::uint32_t j = of_other.begin; j < of_other.end; ++j)
          if (boxes_[i].overlaps(other.boxes_[j])) visit_pair(faces_[i], other.faces_[j]);
      }
      return;
    }
    const bool parts_own = of_other.is_leaf() || (!own.is_leaf() && own.count() >= of_other.count());
    const auto half = [&](std::uint32_t of_own, std::uint32_t beside) {
      parts_own ? between(of_own, other, other_number, visit_pair)
                : between(number, other, beside, visit_pair);
    };
    const auto first = [&] { half(number + 1, other_number + 1); };
    const auto second = [&] { half(own.second, of_other.second); };
    if (std::min(own.count(), of_other.count()) > parallel_size) {
      tbb::parallel_invoke(first, second);
    } else {
      first();
      second();
    }
  }

  template <typename Limit, typename Visit>
  void near(std::uint32_t number, const MortonTree& other, std::uint32_t other_number, const Limit& limit_mm2,
            const Visit& visit_pair) const {
    const Node &own = nodes_[number], &of_other = other.nodes_[other_number];
    if (own.box.squared_distance(of_other.box) > limit_mm2()) return;
    if (own.is_leaf() && of_other.is_leaf()) {
      for (std::uint32_t i = own.begin; i < own.end; ++i)
        for (std::uint32_t j = of_other.begin; j < of_other.end; ++j)
          if (boxes_[i].squared_distance(other.boxes_[j]) <= limit_mm2())
            visit_pair(faces_[i], other.faces_[j]);
      return;
    }
    const bool parts_own = of_other.is_leaf() || (!own.is_leaf() && own.count() >= of_other.count());
    using Pair = std::pair<std::uint32_t, std::uint32_t>;
    std::array<Pair, 2> halves =
        parts_own ? std::array{Pair{number + 1, other_number}, Pair{own.second, other_number}}
                  : std::array{Pair{number, other_number + 1}, Pair{number, of_other.second}};
    const auto apart = [&](const Pair& half) {
      return nodes_[half.first].box.squared_distance(other.nodes_[half.second].box);
    };
    if (apart(halves[1]) < apart(halves[0])) std::swap(halves[0], halves[1]);
    for (const auto& [half, other_half] : halves) near(half, other, other_half, limit_mm2, visit_pair);
  }

  std::vector<std::uint32_t> faces_;  ///< numbers of the faces, in Morton order
  std::vector<OuterBox> boxes_;       ///< boxes of the faces, in Morton order
  std::vector<Node> nodes_;           ///< a parent before its children
};

}  // namespace octotomy::brep
