// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
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

/// An axis-aligned box in single precision, rounded outward: half of double precision's memory, and it misses
/// nothing.
struct OuterBox {
  glm::vec3 low{std::numeric_limits<float>::infinity()};
  glm::vec3 high{-std::numeric_limits<float>::infinity()};
  void add(const glm::dvec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto rounded = static_cast<float>(p[axis]);
      low[axis] = std::min(low[axis], rounded > p[axis]
                                          ? std::nextafter(rounded, -std::numeric_limits<float>::infinity())
                                          : rounded);
      high[axis] = std::max(high[axis], rounded < p[axis]
                                            ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                            : rounded);
    }
  }
  void add(const OuterBox& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  bool overlaps(const OuterBox& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
           low.z <= other.high.z && other.low.z <= high.z;
  }
};

/// The order of points along a Morton curve through their box, equal cells by number. Precondition: all are
/// finite. The same on any number of threads. Cost: linear.
std::vector<std::uint32_t> morton_order(const std::vector<glm::dvec3>& points_mm);

/// Boxes over halves of halves of triangles along a Morton curve; a node stands for a run of the order and is
/// numbered like a heap's. Building: linear; 28 bytes a triangle and 12 to 24 for the nodes.
/// Source: Lauterbach et al., "Fast BVH construction on GPUs", 2009.
class MortonTree {
 public:
  /// Of all triangles, or of some. Precondition: their points are finite.
  explicit MortonTree(const Triangles& surface);
  MortonTree(const Triangles& surface, const std::vector<std::uint32_t>& faces);

  bool empty() const { return faces_.empty(); }

  /// Calls visit(face) for each face whose box and whose nodes' boxes pass `reaches`.
  template <typename Reaches, typename Visit>
  void visit(const Reaches& reaches, const Visit& visit_face) const {
    if (!empty()) visit_node(root(), reaches, visit_face);
  }

  /// Calls visit(face, other) once for each pair of faces of this tree whose boxes overlap, in parallel.
  template <typename Visit>
  void visit_own_pairs(const Visit& visit_pair) const {
    if (!empty()) within(root(), visit_pair);
  }

  /// Calls visit(face of this, face of the other) for each pair whose boxes overlap, in parallel.
  template <typename Visit>
  void visit_pairs(const MortonTree& other, const Visit& visit_pair) const {
    if (!empty() && !other.empty()) between(root(), other, other.root(), visit_pair);
  }

 private:
  static constexpr std::size_t leaf_size = 4;
  static constexpr std::size_t parallel_size = 4096;

  struct Node {
    std::size_t number, begin, end;
    std::size_t count() const { return end - begin; }
    bool is_leaf() const { return count() <= leaf_size; }
    Node first() const { return {2 * number, begin, begin + count() / 2}; }
    Node second() const { return {2 * number + 1, begin + count() / 2, end}; }
  };
  Node root() const { return {1, 0, faces_.size()}; }
  OuterBox build(const Node& node);

  template <typename Reaches, typename Visit>
  void visit_node(const Node& node, const Reaches& reaches, const Visit& visit_face) const {
    if (!reaches(node_boxes_[node.number])) return;
    if (!node.is_leaf()) {
      visit_node(node.first(), reaches, visit_face);
      visit_node(node.second(), reaches, visit_face);
      return;
    }
    for (std::size_t i = node.begin; i < node.end; ++i)
      if (reaches(boxes_[i])) visit_face(faces_[i]);
  }

  template <typename Visit>
  void within(const Node& node, const Visit& visit_pair) const {
    if (node.is_leaf()) {
      for (std::size_t i = node.begin; i < node.end; ++i)
        for (std::size_t j = i + 1; j < node.end; ++j)
          if (boxes_[i].overlaps(boxes_[j])) visit_pair(faces_[i], faces_[j]);
      return;
    }
    const auto first = [&] { within(node.first(), visit_pair); };
    const auto second = [&] { within(node.second(), visit_pair); };
    const auto both = [&] { between(node.first(), *this, node.second(), visit_pair); };
    if (node.count() > parallel_size) {
      tbb::parallel_invoke(first, second, both);
    } else {
      first();
      second();
      both();
    }
  }

  template <typename Visit>
  void between(const Node& own, const MortonTree& other, const Node& of_other,
               const Visit& visit_pair) const {
    if (!node_boxes_[own.number].overlaps(other.node_boxes_[of_other.number])) return;
    if (own.is_leaf() && of_other.is_leaf()) {
      for (std::size_t i = own.begin; i < own.end; ++i)
        for (std::size_t j = of_other.begin; j < of_other.end; ++j)
          if (boxes_[i].overlaps(other.boxes_[j])) visit_pair(faces_[i], other.faces_[j]);
      return;
    }
    const bool halve_own = of_other.is_leaf() || (!own.is_leaf() && own.count() >= of_other.count());
    const auto first = [&] {
      halve_own ? between(own.first(), other, of_other, visit_pair)
                : between(own, other, of_other.first(), visit_pair);
    };
    const auto second = [&] {
      halve_own ? between(own.second(), other, of_other, visit_pair)
                : between(own, other, of_other.second(), visit_pair);
    };
    if (std::min(own.count(), of_other.count()) > parallel_size) {
      tbb::parallel_invoke(first, second);
    } else {
      first();
      second();
    }
  }

  std::vector<std::uint32_t> faces_;  ///< in the order
  std::vector<OuterBox> boxes_;       ///< of the faces, in the order
  std::vector<OuterBox> node_boxes_;
};

}  // namespace octotomy::brep
