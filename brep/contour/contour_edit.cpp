// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/contour_edit.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Segment_2.h>
#include <CGAL/intersections.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string>

#include "brep/contour/run_tree.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

void need_number(std::size_t number, std::size_t count, const char* what) {
  if (number >= count)
    throw InvalidInput("contour: there is no " + std::string(what) + " " + std::to_string(number) +
                       ", it has " + std::to_string(count));
}

void need_finite(const glm::dvec2& p) {
  if (!std::isfinite(p.x) || !std::isfinite(p.y)) throw InvalidInput("contour: a point is not finite");
}

Contour whole(Contour contour) {
  const std::size_t least = contour.closed ? 3 : 2;
  if (contour.points_mm.size() < least)
    throw InvalidInput("contour: " + std::to_string(contour.points_mm.size()) +
                       " points would be left, at least " + std::to_string(least) + " are needed");
  return contour;
}

/// The points from one to another along a closed contour, both included.
std::vector<glm::dvec2> run(const Contour& contour, std::size_t from, std::size_t to) {
  const std::size_t count = contour.points_mm.size();
  std::vector<glm::dvec2> points = {contour.points_mm[from]};
  while (from != to) {
    from = (from + 1) % count;
    points.push_back(contour.points_mm[from]);
  }
  return points;
}

/// A contour's pieces, for exact tests of intersection.
class Pieces {
 public:
  explicit Pieces(const Contour& contour) : contour_(contour), count_(piece_count(contour)) {}

  std::size_t count() const { return count_; }
  /// Whether two pieces have a common point other than the corner that neighbours share. Precondition: i < j.
  bool meet(std::size_t i, std::size_t j) const {
    assert(i < j && j < count_);
    const bool follows = j == i + 1, closes = contour_.closed && i == 0 && j + 1 == count_;
    if (!follows && !closes) return CGAL::do_intersect(piece(i), piece(j));
    // Neighbours share a corner. They share more only if one runs back over the other.
    return (follows && (piece(j).has_on(point(i)) || piece(i).has_on(point(j + 1)))) ||
           (closes && (piece(j).has_on(point(1)) || piece(0).has_on(point(j))));
  }

 private:
  Kernel::Point_2 point(std::size_t i) const {
    const glm::dvec2& p = contour_.points_mm[i % contour_.points_mm.size()];
    return {p.x, p.y};
  }
  Kernel::Segment_2 piece(std::size_t i) const { return {point(i), point(i + 1)}; }

  const Contour& contour_;
  std::size_t count_;
};

}  // namespace

Contour point_moved(const Contour& contour, std::size_t point, const glm::dvec2& to_mm) {
  need_number(point, contour.points_mm.size(), "point");
  need_finite(to_mm);
  Contour edited = contour;
  edited.points_mm[point] = to_mm;
  return edited;
}

Contour point_inserted(const Contour& contour, std::size_t piece, const glm::dvec2& at_mm) {
  need_number(piece, piece_count(contour), "piece");
  need_finite(at_mm);
  Contour edited = contour;
  edited.points_mm.insert(edited.points_mm.begin() + static_cast<std::ptrdiff_t>(piece) + 1, at_mm);
  return edited;
}

Contour point_deleted(const Contour& contour, std::size_t point) {
  need_number(point, contour.points_mm.size(), "point");
  Contour edited = contour;
  edited.points_mm.erase(edited.points_mm.begin() + static_cast<std::ptrdiff_t>(point));
  return whole(std::move(edited));
}

std::pair<Contour, Contour> split(const Contour& contour, std::size_t first, std::size_t second) {
  need_number(first, contour.points_mm.size(), "point");
  need_number(second, contour.points_mm.size(), "point");
  if (!contour.closed) throw InvalidInput("contour: an open contour is split at one point, not between two");
  return {whole({run(contour, first, second), true}), whole({run(contour, second, first), true})};
}

std::pair<Contour, Contour> split(const Contour& contour, std::size_t point) {
  need_number(point, contour.points_mm.size(), "point");
  if (contour.closed) throw InvalidInput("contour: a closed contour is split between two points, not at one");
  const auto at = contour.points_mm.begin() + static_cast<std::ptrdiff_t>(point);
  return {whole({{contour.points_mm.begin(), at + 1}, false}), whole({{at, contour.points_mm.end()}, false})};
}

Contour joined(const Contour& a, std::size_t piece_of_a, const Contour& b, std::size_t piece_of_b) {
  if (!a.closed || !b.closed)
    throw InvalidInput("contour: only closed contours can be joined at a piece of each");
  need_number(piece_of_a, piece_count(a), "piece");
  need_number(piece_of_b, piece_count(b), "piece");
  Contour both{run(a, (piece_of_a + 1) % a.points_mm.size(), piece_of_a), true};
  const std::vector<glm::dvec2> other = run(b, (piece_of_b + 1) % b.points_mm.size(), piece_of_b);
  both.points_mm.insert(both.points_mm.end(), other.begin(), other.end());
  return whole(std::move(both));
}

Contour joined(const Contour& a, const Contour& b) {
  if (a.closed || b.closed) throw InvalidInput("contour: only open contours can be joined end to start");
  Contour both = a;
  both.points_mm.insert(both.points_mm.end(), b.points_mm.begin(), b.points_mm.end());
  return whole(std::move(both));
}

Contour closed(const Contour& contour) {
  Contour edited = contour;
  edited.closed = true;
  return whole(std::move(edited));
}

std::optional<std::pair<std::size_t, std::size_t>> first_crossing(const Contour& contour) {
  const Pieces pieces(contour);
  const RunTree tree(contour);
  for (std::size_t i = 0; i < pieces.count(); ++i) {
    const PlaneBox own = box_of_piece(contour, i);
    const auto j = tree.first(
        i + 1, pieces.count(), [&](const PlaneBox& box) { return box.overlaps(own); },
        [&](std::size_t other) { return pieces.meet(i, other); });
    if (j) return std::pair(i, *j);
  }
  return std::nullopt;
}

std::optional<std::pair<std::size_t, std::size_t>> first_crossing_of(const Contour& contour,
                                                                     std::span<const std::size_t> changed) {
  const Pieces pieces(contour);
  std::optional<std::pair<std::size_t, std::size_t>> first;
  for (const std::size_t edited : changed) {
    assert(edited < pieces.count());
    const PlaneBox own = box_of_piece(contour, edited);
    for (std::size_t other = 0; other < pieces.count(); ++other) {
      if (other == edited || !box_of_piece(contour, other).overlaps(own)) continue;
      const std::pair<std::size_t, std::size_t> both = std::minmax(edited, other);
      if ((!first || both < *first) && pieces.meet(both.first, both.second)) first = both;
    }
  }
  return first;
}

}  // namespace octotomy::brep
