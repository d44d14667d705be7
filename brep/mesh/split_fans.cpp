// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 sort the sides of all triangles by edge; 2 join the sides of each edge in pairs, by their angle around
// the edge unless there are exactly two that fit; 3 join the corners of triangles across joined sides to
// fans; 4 create a copy of the point for each fan at a point except the first; 5 if several pairs of one edge
// still share both its ends, create for each further pair a point in the edge's middle.
#include "brep/mesh/split_fans.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/sides.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // of corners

bool fits(const Side* begin, const Side* end) {
  return end - begin == 1 || (end - begin == 2 && begin[0].upward != begin[1].upward);
}

/// A triangle that runs up the edge has the solid at smaller angles, a triangle that runs down has it at
/// larger angles. In order of falling angle, an upward triangle therefore opens a part of the solid and the
/// next downward one closes it.
void join_by_angle(const Triangles& triangles, const Side* begin, const Side* end,
                   const std::vector<std::uint8_t>& ends_elsewhere, Pairs& pairs) {
  const glm::dvec3 low = triangles.points_mm[begin->low];
  const glm::dvec3 along = triangles.points_mm[begin->high] - low;
  const double length2 = glm::dot(along, along);
  const auto arm = [&](const Side& side) {
    const glm::dvec3 d = triangles.points_mm[triangles.faces[side.corner / 3][(side.corner + 2) % 3]] - low;
    return length2 > 0.0 ? d - glm::dot(d, along) / length2 * along : d;
  };
  const glm::dvec3 x = arm(*begin), y = glm::cross(along, x);
  struct Turned {
    double angle;
    const Side* side;
  };
  std::vector<Turned> turned;
  for (const Side* side = begin; side != end; ++side) {
    const glm::dvec3 d = arm(*side);
    const double across = glm::dot(d, y) / std::sqrt(std::max(length2, std::numeric_limits<double>::min()));
    turned.push_back({std::atan2(across, glm::dot(d, x)), side});
  }
  // Among coinciding triangles, those that close a part come first, so that no part without thickness is
  // created.
  std::sort(turned.begin(), turned.end(), [](const Turned& a, const Turned& b) {
    return std::tuple(-a.angle, a.side->upward, a.side->corner) <
           std::tuple(-b.angle, b.side->upward, b.side->corner);
  });
  const auto balanced =
      2 * std::count_if(begin, end, [](const Side& side) { return side.upward; }) == end - begin;
  std::vector<std::uint8_t> joined(turned.size(), 0);
  const auto pass = [&](const auto& takes_part) {
    std::vector<std::size_t> open;
    for (std::size_t n = 0; n < 2 * turned.size(); ++n) {
      const std::size_t i = n % turned.size();
      if (joined[i] || !takes_part(*turned[i].side)) continue;
      if (turned[i].side->upward) {
        if (n < turned.size()) open.push_back(i);
      } else if (!open.empty()) {
        pairs.emplace_back(turned[open.back()].side->corner, turned[i].side->corner);
        joined[i] = joined[open.back()] = 1;
        open.pop_back();
      }
    }
  };
  // If the numbers of upward and downward sides differ, some triangles end here: preferably those that also
  // end elsewhere, like fins.
  if (!balanced) pass([&](const Side& side) { return !ends_elsewhere[side.corner / 3]; });
  pass([](const Side&) { return true; });
}

/// A pair of corners whose sides are joined; at a border both are the same corner.
struct Group {
  std::uint32_t first, second;
};

/// Divides triangles at points in the middle of their sides (`none` for sides without one). The first part
/// keeps the triangle's number.
void cut_at_middles(const std::vector<std::uint32_t>& middle, SplitFans& split) {
  const std::size_t count = split.surface.faces.size();
  assert(middle.size() == 3 * count);
  for (std::size_t f = 0; f < count; ++f) {
    const std::array<std::uint32_t, 3> m = {middle[3 * f], middle[3 * f + 1], middle[3 * f + 2]};
    const auto cuts = static_cast<std::size_t>(3 - std::count(m.begin(), m.end(), none));
    if (cuts == 0) continue;
    const auto corner = split.surface.faces[f];
    // Rotates the corners so that a single cut is on the first side and, with two cuts, the last side has
    // none.
    std::size_t k = 0;
    while (cuts < 3 && !(m[k] != none && m[(k + 2) % 3] == none)) ++k;
    const std::uint32_t a = corner[k], b = corner[(k + 1) % 3], c = corner[(k + 2) % 3];
    const std::uint32_t ab = m[k], bc = m[(k + 1) % 3], ca = m[(k + 2) % 3];
    std::vector<std::array<std::uint32_t, 3>> parts;
    if (cuts == 1) parts = {{a, ab, c}, {ab, b, c}};
    if (cuts == 2) parts = {{ab, b, bc}, {a, ab, bc}, {a, bc, c}};
    if (cuts == 3) parts = {{ab, bc, ca}, {a, ab, ca}, {ab, b, bc}, {ca, bc, c}};
    split.surface.faces[f] = parts[0];
    split.surface.faces.insert(split.surface.faces.end(), parts.begin() + 1, parts.end());
    split.face_origin.insert(split.face_origin.end(), parts.size() - 1, split.face_origin[f]);
  }
}

void check(const Triangles& triangles) {
  for (std::size_t f = 0; f < triangles.faces.size(); ++f)
    for (const std::uint32_t v : triangles.faces[f]) {
      if (v >= triangles.points_mm.size())
        throw Error(ErrorCode::Input, "triangle " + std::to_string(f) + " refers to point " +
                                          std::to_string(v) + " of " +
                                          std::to_string(triangles.points_mm.size()));
      const glm::dvec3& p = triangles.points_mm[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        throw Error(ErrorCode::Input, "triangle " + std::to_string(f) +
                                          " has a point that is not finite; octotomy repair --solid leaves "
                                          "such triangles out");
    }
}

/// The defects that prevent triangles from being joined in pairs.
struct Unfit {
  std::size_t open = 0;  ///< edges of one triangle
  bool any = false;      ///< an edge of more than two triangles or with inconsistent winding, or a triangle
                         ///< that repeats a point
};

Unfit unfit_of(const Triangles& triangles) {
  std::atomic<std::size_t> open = 0;
  std::atomic<bool> any = std::any_of(triangles.faces.begin(), triangles.faces.end(), [](const auto& face) {
    return face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
  });
  each_edge_in_parallel(triangles, [&](const Side* begin, const Side* end) {
    if (end - begin == 1) ++open;
    if (!fits(begin, end)) any = true;
  });
  return {open, any};
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

SplitFans split_fans(const Triangles& triangles) {
  check(triangles);
  SplitFans split;
  split.surface.points_mm = triangles.points_mm;
  split.origin.resize(triangles.points_mm.size());
  for (std::uint32_t v = 0; v < split.origin.size(); ++v) split.origin[v] = v;
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f) {
    const auto& face = triangles.faces[f];
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
      split.left_out.push_back(f);
    } else {
      split.surface.faces.push_back(face);
      split.face_origin.push_back(f);
    }
  }
  const std::vector<Side> sides = sorted_sides(split.surface);
  std::vector<std::uint8_t> ends_elsewhere(split.surface.faces.size(), 0);
  each_edge(sides, [&](const Side* begin, const Side* end) {
    if (end - begin == 1) ends_elsewhere[begin->corner / 3] = 1;
  });
  DisjointSets fans(sides.size());
  std::vector<std::vector<Group>> groups;  // groups of each edge that is split
  each_edge(sides, [&](const Side* begin, const Side* end) {
    Pairs pairs;
    if (fits(begin, end)) {
      if (end - begin == 2) pairs.emplace_back(begin[0].corner, begin[1].corner);
    } else {
      join_by_angle(split.surface, begin, end, ends_elsewhere, pairs);
      split.edges.push_back({begin->low, begin->high, static_cast<std::size_t>(end - begin), pairs.size(),
                             0.5 * triangles.points_mm[begin->low] + 0.5 * triangles.points_mm[begin->high]});
      std::vector<Group>& own = groups.emplace_back();
      for (const auto& [c, d] : pairs) own.push_back({c, d});
      for (const Side* side = begin; side != end; ++side)
        if (std::none_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
              return pair.first == side->corner || pair.second == side->corner;
            }))
          own.push_back({side->corner, side->corner});
    }
    for (const auto& [c, d] : pairs) {
      fans.join(c, next_corner(d));
      fans.join(next_corner(c), d);
    }
  });

  // A fan is identified by its first corner; the first fan at a point keeps the point.
  std::vector<std::uint32_t> place(sides.size(), none);
  std::vector<std::uint8_t> taken(triangles.points_mm.size(), 0);
  for (std::uint32_t c = 0; c < place.size(); ++c) {
    std::uint32_t& v = split.surface.faces[c / 3][c % 3];
    const std::uint32_t fan = fans.set_of(c);
    if (place[fan] == none) {
      assert(fan == c);
      place[fan] = v;
      if (taken[v]) {
        place[fan] = static_cast<std::uint32_t>(split.surface.points_mm.size());
        split.surface.points_mm.push_back(triangles.points_mm[v]);
        split.origin.push_back(v);
      }
      taken[v] = 1;
    }
    v = place[fan];
  }

  std::vector<std::uint32_t> middle(sides.size(), none);
  bool is_cut = false;
  for (std::size_t e = 0; e < groups.size(); ++e) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> known;
    for (const Group& group : groups[e]) {
      const auto& face = split.surface.faces[group.first / 3];
      const std::uint32_t from = face[group.first % 3], to = face[(group.first + 1) % 3];
      const std::pair ends(std::min(from, to), std::max(from, to));
      if (std::find(known.begin(), known.end(), ends) == known.end()) {
        known.push_back(ends);
        continue;
      }
      middle[group.first] = middle[group.second] = static_cast<std::uint32_t>(split.surface.points_mm.size());
      split.surface.points_mm.push_back(split.edges[e].at_mm);
      split.origin.push_back(split.edges[e].from);
      is_cut = true;
    }
  }
  if (is_cut) cut_at_middles(middle, split);
  return split;
}

std::string to_string(const SplitEdge& edge) {
  const std::size_t ends = edge.triangles - 2 * edge.pairs;
  return "edge of " + counted(edge.triangles, "triangle") + " at (" + short_text(edge.at_mm.x) + ", " +
         short_text(edge.at_mm.y) + ", " + short_text(edge.at_mm.z) + ") mm, points " +
         std::to_string(edge.from) + " and " + std::to_string(edge.to) + ": " + counted(edge.pairs, "pair") +
         " joined" + (ends == 0 ? "" : ", " + counted(ends, "triangle") + " ending there");
}

JoinedSurface joined_surface(Triangles triangles) {
  check(triangles);
  JoinedSurface joined;
  Unfit unfit = unfit_of(triangles);
  if (unfit.open > 0) {
    const std::vector<std::uint32_t> first = first_equal_points(triangles.points_mm);
    Triangles welded = triangles;
    for (auto& face : welded.faces)
      for (std::uint32_t& v : face) v = first[v];
    const Unfit still = unfit_of(welded);
    if (still.open < unfit.open) {
      joined.findings.push_back("unwelded: " + std::to_string(unfit.open - still.open) + " of " +
                                std::to_string(unfit.open) +
                                " open edges closed by merging points that coincide");
      triangles = std::move(welded);
      unfit = still;
    }
  }
  joined.surface = std::move(triangles);
  if (!unfit.any) return joined;
  SplitFans split = split_fans(joined.surface);
  if (!split.left_out.empty())
    joined.findings.push_back(counted(split.left_out.size(), "triangle") + " that repeat" +
                              (split.left_out.size() == 1 ? "s" : "") +
                              " a point left out (first: triangle " + std::to_string(split.left_out.front()) +
                              ")");
  constexpr std::size_t told = 10;
  for (std::size_t i = 0; i < std::min(told, split.edges.size()); ++i)
    joined.findings.push_back("split: " + to_string(split.edges[i]));
  if (split.edges.size() > told)
    joined.findings.push_back("split: " + std::to_string(split.edges.size() - told) +
                              " more edges with three or more triangles, or with contrary ones");
  if (!split.left_out.empty() || !split.edges.empty()) joined.surface = std::move(split.surface);
  return joined;
}

}  // namespace octotomy::brep
