// SPDX-License-Identifier: AGPL-3.0-or-later
// If a whole shell of one operand coincides with a shell of the other, CGAL assumes that both have the same
// orientation: it checks the orientation of each whole operand only. A plug in the cavity that it fills then
// counts as the common part of both. These functions find coincident shells of opposite orientation and
// correct the results.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "brep/boolean/corefine.h"
#include "brep/mesh/disjoint_sets.h"

namespace octotomy::brep {

/// Triangles over points of any type, which are compared by `less`.
template <typename Point>
struct PointTriangles {
  std::vector<Point> points;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// The faces of a shell, ascending.
using Shell = std::vector<std::uint32_t>;

/// The shells, connected across points, and each one's least point. Cost: linear.
template <typename Point, typename Less>
std::vector<std::pair<std::uint32_t, Shell>> shells_by_least_point(const PointTriangles<Point>& surface,
                                                                   const Less& less) {
  DisjointSets sets(surface.points.size());
  for (const auto& face : surface.faces) {
    sets.join(face[0], face[1]);
    sets.join(face[1], face[2]);
  }
  std::vector<std::pair<std::uint32_t, Shell>> shells;
  std::vector<std::uint32_t> number(surface.points.size(), 0);  // number of the point's shell plus one
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f) {
    const auto& face = surface.faces[f];
    std::uint32_t& known = number[sets.set_of(face[0])];
    if (known == 0) {
      shells.push_back({face[0], {}});
      known = static_cast<std::uint32_t>(shells.size());
    }
    auto& [least, faces] = shells[known - 1];
    faces.push_back(f);
    for (const std::uint32_t v : face)
      if (less(surface.points[v], surface.points[least])) least = v;
  }
  return shells;
}

/// A surface of the given faces only.
template <typename Point>
PointTriangles<Point> part_of(const PointTriangles<Point>& surface, const Shell& faces) {
  constexpr auto none = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> number(surface.points.size(), none);
  PointTriangles<Point> part;
  for (const std::uint32_t f : faces) {
    part.faces.push_back(surface.faces[f]);
    for (std::uint32_t& v : part.faces.back()) {
      if (number[v] == none) {
        number[v] = static_cast<std::uint32_t>(part.points.size());
        part.points.push_back(surface.points[v]);
      }
      v = number[v];
    }
  }
  return part;
}

/// Whether the triangles of both surfaces are the same, with opposite winding if `contrary` is set.
template <typename Point, typename Less>
bool coincide(const PointTriangles<Point>& a, const PointTriangles<Point>& b, bool contrary,
              const Less& less) {
  if (a.faces.size() != b.faces.size()) return false;
  const auto places_of = [&](const PointTriangles<Point>& surface, bool turned) {
    std::vector<std::array<Point, 3>> places;
    for (const auto& face : surface.faces) {
      std::array<Point, 3> place{surface.points[face[0]], surface.points[face[turned ? 2 : 1]],
                                 surface.points[face[turned ? 1 : 2]]};
      std::rotate(place.begin(), std::min_element(place.begin(), place.end(), less), place.end());
      places.push_back(std::move(place));
    }
    const auto before = [&](const std::array<Point, 3>& p, const std::array<Point, 3>& q) {
      return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end(), less);
    };
    std::sort(places.begin(), places.end(), before);
    return places;
  };
  return places_of(a, contrary) == places_of(b, false);
}

/// The pairs of shells, one from each surface, that have the same triangles. Cost: linear, and n log n for
/// shells that share their least point.
template <typename Point, typename Less>
std::vector<std::array<Shell, 2>> coincident_shells(const PointTriangles<Point>& a,
                                                    const PointTriangles<Point>& b, bool contrary,
                                                    const Less& less) {
  auto of_a = shells_by_least_point(a, less), of_b = shells_by_least_point(b, less);
  std::stable_sort(of_b.begin(), of_b.end(),
                   [&](const auto& p, const auto& q) { return less(b.points[p.first], b.points[q.first]); });
  std::vector<std::array<Shell, 2>> pairs;
  for (auto& [least, shell] : of_a) {
    const Point& point = a.points[least];
    auto other = std::lower_bound(of_b.begin(), of_b.end(), point,
                                  [&](const auto& p, const Point& q) { return less(b.points[p.first], q); });
    for (; other != of_b.end() && !less(point, b.points[other->first]); ++other) {
      if (!coincide(part_of(a, shell), part_of(b, other->second), contrary, less)) continue;
      pairs.push_back({std::move(shell), std::move(other->second)});
      break;
    }
  }
  return pairs;
}

/// Corrects the results of corefined operands for whole shells that coincide with opposite orientation:
/// neither belongs to the union or the intersection, and each belongs to its operand's difference. CGAL
/// assumed the same orientation for the shell of `a`. This does not affect other parts. Returns the number of
/// pairs. Cost: linear if there are none.
template <typename Point, typename Less>
std::size_t correct_contrary_shells(const PointTriangles<Point>& a, const PointTriangles<Point>& b,
                                    std::array<std::optional<PointTriangles<Point>>, 4>& results,
                                    const Less& less) {
  const std::vector<std::array<Shell, 2>> pairs = coincident_shells(a, b, true, less);
  if (pairs.empty()) return 0;
  const auto shells_of = [&](std::size_t operand) {
    Shell faces;
    for (const auto& pair : pairs) faces.insert(faces.end(), pair[operand].begin(), pair[operand].end());
    return part_of(operand == 0 ? a : b, faces);
  };
  const std::array<PointTriangles<Point>, 2> shells{shells_of(0), shells_of(1)};
  for (const ResultPlace place : {of_union, of_intersection}) {
    if (!results[place]) continue;
    std::vector<bool> goes(results[place]->faces.size(), false);
    for (const auto& pair : coincident_shells(*results[place], shells[0], false, less))
      for (const std::uint32_t f : pair[0]) goes[f] = true;
    Shell kept;
    for (std::uint32_t f = 0; f < goes.size(); ++f)
      if (!goes[f]) kept.push_back(f);
    results[place] = part_of(*results[place], kept);
  }
  for (const ResultPlace place : {of_a_minus_b, of_b_minus_a}) {
    if (!results[place]) continue;
    PointTriangles<Point>& result = *results[place];
    const PointTriangles<Point>& added = shells[place == of_a_minus_b ? 0 : 1];
    const auto shift = static_cast<std::uint32_t>(result.points.size());
    result.points.insert(result.points.end(), added.points.begin(), added.points.end());
    for (const auto& face : added.faces)
      result.faces.push_back({face[0] + shift, face[1] + shift, face[2] + shift});
  }
  return pairs.size();
}

}  // namespace octotomy::brep
