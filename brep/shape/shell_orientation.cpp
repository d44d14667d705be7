// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/shell_orientation.h"

#include <algorithm>
#include <cassert>

#include "brep/mesh/distance.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/sides.h"

namespace octotomy::brep {
namespace {

using Face = std::array<std::uint32_t, 3>;

/// The other closed shells that contain all of a shell's probes, identified by their first triangles. Shells
/// that cross this shell do not contain all of its probes.
std::vector<std::uint32_t> shells_around(std::uint32_t first, const Shell& own,
                                         const std::map<std::uint32_t, Shell>& shells,
                                         const std::vector<std::uint32_t>& shell, const Triangles& wound,
                                         const SurfaceTree& tree) {
  std::map<std::uint32_t, std::size_t> containing;
  std::size_t probes = 0;
  for (const auto& probe : own.probes) {
    if (!probe) continue;
    ++probes;
    std::map<std::uint32_t, bool> within;
    for (const Crossing& crossing : tree.crossings(wound.points_mm[*probe]))
      if (shell[crossing.face] != first) within[shell[crossing.face]] ^= true;
    for (const auto& [other, is_within] : within) containing[other] += is_within;
  }
  std::vector<std::uint32_t> around;
  for (const auto& [other, count] : containing)
    if (count == probes && probes > 0 && shells.at(other).is_closed) around.push_back(other);
  return around;
}

}  // namespace

bool Neighbours::is_open() const {
  return std::find(face.begin(), face.end(), none) != face.end();
}

Neighbours neighbours_of(const Triangles& surface) {
  Neighbours neighbours{std::vector<std::uint32_t>(3 * surface.faces.size(), Neighbours::none),
                        std::vector<std::uint8_t>(3 * surface.faces.size(), 0)};
  each_edge(sorted_sides(surface), [&](const Side* begin, const Side* end) {
    if (end - begin != 2) return;
    const std::uint32_t c = begin[0].corner, d = begin[1].corner;
    neighbours.face[c] = d / 3;
    neighbours.face[d] = c / 3;
    neighbours.same_way[c] = neighbours.same_way[d] = begin[0].upward == begin[1].upward;
  });
  return neighbours;
}

/// Floods across edges that exactly two triangles share, and winds each shell consistently.
Shells wind_alike(const Neighbours& neighbours) {
  const std::size_t count = neighbours.face.size() / 3;
  Shells shells{std::vector<std::uint32_t>(count, Neighbours::none), std::vector<std::uint8_t>(count, 0), 0};
  std::vector<std::uint32_t> flood;
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (shells.of[seed] != Neighbours::none) continue;
    shells.of[seed] = seed;
    flood.assign(1, seed);
    while (!flood.empty()) {
      const std::uint32_t f = flood.back();
      flood.pop_back();
      for (std::uint32_t c = 3 * f; c < 3 * f + 3; ++c) {
        const std::uint32_t other = neighbours.face[c];
        if (other == Neighbours::none) continue;
        const std::uint8_t wanted = (neighbours.same_way[c] != 0) != (shells.turned[f] != 0);
        if (shells.of[other] == Neighbours::none) {
          shells.of[other] = seed;
          shells.turned[other] = wanted;
          flood.push_back(other);
        } else if (shells.turned[other] != wanted) {
          ++shells.twisted_sides;
        }
      }
    }
  }
  return shells;
}

std::map<std::uint32_t, Shell> shells_of(const Triangles& wound, const Neighbours& neighbours,
                                         const Shells& shells) {
  const std::vector<std::uint32_t>& shell = shells.of;
  std::map<std::uint32_t, Shell> found;
  // For each position, the shell with corners there, or `several`.
  const std::vector<std::uint32_t> place = first_equal_points(wound.points_mm);
  constexpr std::uint32_t several = Neighbours::none - 1;
  std::vector<std::uint32_t> owner(wound.points_mm.size(), Neighbours::none);
  for (std::uint32_t f = 0; f < shell.size(); ++f)
    for (const std::uint32_t v : wound.faces[f]) {
      std::uint32_t& own = owner[place[v]];
      own = own == Neighbours::none || own == shell[f] ? shell[f] : several;
    }
  for (std::uint32_t f = 0; f < shell.size(); ++f) {
    Shell& own = found[shell[f]];
    const Face& face = wound.faces[f];
    // Sums relative to the shell's first point, which preserves digits far from the origin.
    const glm::dvec3 tip = wound.points_mm[wound.faces[shell[f]][0]];
    const glm::dvec3 p = wound.points_mm[face[0]] - tip, q = wound.points_mm[face[1]] - tip,
                     r = wound.points_mm[face[2]] - tip;
    own.volume_mm3 += glm::dot(p, glm::cross(q, r)) / 6.0;
    own.area_mm2 += 0.5 * glm::length(glm::cross(q - p, r - p));
    own.turns += shells.turned[f];
    own.faces.push_back(f);
    for (std::size_t k = 0; k < 3; ++k) {
      own.is_closed &= neighbours.face[3 * f + k] != Neighbours::none;
      const std::uint32_t v = face[k];
      if (owner[place[v]] != shell[f]) continue;
      for (std::size_t way = 0; way < 6; ++way) {
        const auto along = [&](std::uint32_t w) {
          return (way < 3 ? 1.0 : -1.0) * wound.points_mm[w][static_cast<int>(way % 3)];
        };
        if (!own.probes[way] || along(v) > along(*own.probes[way])) own.probes[way] = v;
      }
    }
  }
  return found;
}

void place_shells(const Triangles& surface, const Neighbours& neighbours, Nested nested, Shells& shells) {
  std::vector<std::uint8_t>& turned = shells.turned;
  assert(turned.size() == surface.faces.size() && shells.of.size() == turned.size());
  Triangles wound = surface;
  for (std::size_t f = 0; f < turned.size(); ++f)
    if (turned[f]) std::swap(wound.faces[f][1], wound.faces[f][2]);
  const std::map<std::uint32_t, Shell> placed = shells_of(wound, neighbours, shells);
  const SurfaceTree tree(wound);
  std::map<std::uint32_t, std::vector<std::uint32_t>> around;
  for (const auto& [first, own] : placed)
    if (own.is_closed) around[first] = shells_around(first, own, placed, shells.of, wound, tree);
  // If an outermost shell of the input faces inward or is inconsistent, the orientation of shells carries no
  // information.
  const bool ways_hold =
      nested == Nested::AsGiven && std::all_of(around.begin(), around.end(), [&](const auto& place) {
        const Shell& own = placed.at(place.first);
        return !place.second.empty() || (own.turns == 0 && own.volume_mm3 > 0.0);
      });
  for (const auto& [first, own] : placed) {
    bool wrong = 2 * own.turns > own.faces.size();
    if (own.is_closed) {
      const std::vector<std::uint32_t>& others = around.at(first);
      wrong = (own.volume_mm3 < 0.0) != (others.size() % 2 == 1);
      int winding = 0;
      for (const std::uint32_t other : others) winding += placed.at(other).volume_mm3 > 0.0 ? 1 : -1;
      if (ways_hold && own.turns == 0 && !others.empty())
        wrong = own.volume_mm3 < 0.0 ? winding < 1 : winding < 0;
    }
    if (wrong)
      for (const std::uint32_t f : own.faces) turned[f] ^= 1u;
  }
}

}  // namespace octotomy::brep
