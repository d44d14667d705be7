// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/shape/repair_effect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/line_volume.h"
#include "brep/mesh/measure.h"

namespace octotomy::brep {

RepairEffect repair_effect(const Triangles& before, const Triangles& after, const KnownSolids& solids) {
  const auto finite_of = [](const Triangles& surface) {
    Triangles finite{surface.points_mm, {}};
    const auto is_finite = [](const glm::dvec3& p) { return std::isfinite(glm::dot(p, glm::dvec3(1.0))); };
    for (const auto& face : surface.faces)
      if (std::all_of(face.begin(), face.end(),
                      [&](std::uint32_t v) { return is_finite(surface.points_mm[v]); }))
        finite.faces.push_back(face);
    return finite;
  };
  const Triangles was = finite_of(before), is = finite_of(after);
  RepairEffect effect;
  const LineVolumes volumes = line_volumes(was, {});
  effect.volume_before_mm3 = volumes.all.a_mm3;
  if (volumes.lines > 0)
    effect.open_line_share = static_cast<double>(volumes.open_lines) / static_cast<double>(volumes.lines);
  const Size size_before = size_of(was), size_after = size_of(is);
  if (solids.before) effect.volume_before_mm3 = size_before.volume_mm3;
  effect.volume_after_mm3 = solids.after ? size_after.volume_mm3 : line_volumes(is, {}).all.a_mm3;
  effect.area_before_mm2 = size_before.area_mm2;
  effect.area_after_mm2 = size_after.area_mm2;
  const auto measure = [&](const Triangles& from, const Triangles& to) {
    if (from.faces.empty() || to.faces.empty()) return;
    // Collects each point once, then the triangles' middles.
    std::vector<glm::dvec3> points;
    constexpr std::uint32_t unplaced = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place(from.points_mm.size(), unplaced);
    for (const auto& face : from.faces)
      for (const std::uint32_t v : face) {
        if (place[v] != unplaced) continue;
        place[v] = static_cast<std::uint32_t>(points.size());
        points.push_back(from.points_mm[v]);
      }
    for (const auto& face : from.faces)
      points.push_back((from.points_mm[face[0]] + from.points_mm[face[1]] + from.points_mm[face[2]]) / 3.0);
    const std::vector<double> distances = SurfaceTree(to, SurfaceTree::Build::Hasty).distances_mm(points);
    // Among equally distant positions, stores the first in the order of the triangles.
    const auto add = [&](std::size_t i) {
      if (distances[i] <= effect.largest_distance_mm) return;
      effect.largest_distance_mm = distances[i];
      effect.largest_at_mm = points[i];
    };
    const std::size_t middles = points.size() - from.faces.size();
    for (std::size_t f = 0; f < from.faces.size(); ++f) {
      for (const std::uint32_t v : from.faces[f]) add(place[v]);
      add(middles + f);
    }
  };
  measure(was, is);
  measure(is, was);
  return effect;
}

}  // namespace octotomy::brep
