// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "brep/contour/contour.h"

namespace octotomy::brep {

/// An axis-aligned box in a plane, initially empty.
struct PlaneBox {
  glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec2& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  void add(const PlaneBox& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  bool holds(const glm::dvec2& p) const { return overlaps({p, p}); }
  /// Whether the boxes overlap or touch.
  bool overlaps(const PlaneBox& other) const {
    return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y;
  }
  /// The distance from p to the farthest point of the box.
  double farthest(const glm::dvec2& p) const {
    const glm::dvec2 away = glm::max(high - p, p - low);
    return glm::length(away);
  }
};

/// The number of a contour's pieces: one for each point, or one fewer if the contour is open.
std::size_t piece_count(const Contour& contour);

/// The box of the piece that begins at point `piece`.
PlaneBox box_of_piece(const Contour& contour, std::size_t piece);

/// Boxes around the runs that result from halving a sequence repeatedly. Queries are fast if neighbours in
/// the sequence are near each other, like a contour's pieces. Building: linear, 64 bytes per item.
class RunTree {
 public:
  /// A tree over items in their order.
  explicit RunTree(const std::vector<PlaneBox>& items);
  /// A tree over a contour's pieces, numbered by their first points.
  explicit RunTree(const Contour& contour);

  /// Calls enter(box, begin, end) for the run of all items. If it returns true for a run of two or more
  /// items, calls it for both halves of the run, in order.
  template <typename Enter>
  void walk(const Enter& enter) const {
    if (count_ > 0) walk_run(0, 0, count_, enter);
  }
  /// The first item in from..until - 1 for which `hit` returns true. Only items are tested for which
  /// `reaches` returns true for the item's box and for the boxes of all runs that contain the item.
  template <typename Reaches, typename Hit>
  std::optional<std::size_t> first(std::size_t from, std::size_t until, const Reaches& reaches,
                                   const Hit& hit) const {
    std::optional<std::size_t> found;
    walk([&](const PlaneBox& box, std::size_t begin, std::size_t end) {
      if (found || end <= from || begin >= until || !reaches(box)) return false;
      if (end - begin == 1 && hit(begin)) found = begin;
      return true;
    });
    return found;
  }

 private:
  void append(const std::vector<PlaneBox>& items, std::size_t begin, std::size_t end);

  // A run of n items has 2 n - 1 nodes: its own, then those of its first half, then those of its second half.
  template <typename Enter>
  void walk_run(std::size_t node, std::size_t begin, std::size_t end, const Enter& enter) const {
    assert(begin < end && node < boxes_.size());
    if (!enter(boxes_[node], begin, end) || end - begin == 1) return;
    const std::size_t middle = begin + (end - begin) / 2;
    walk_run(node + 1, begin, middle, enter);
    walk_run(node + 2 * (middle - begin), middle, end, enter);
  }

  std::size_t count_ = 0;
  std::vector<PlaneBox> boxes_;  ///< of runs
};

}  // namespace octotomy::brep
