// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/deck/cut_surfaces.h"

#include <algorithm>
#include <limits>

namespace octotomy::planner {
namespace {

/// A point of a cut lies at most this far from the mask's wall, because corefinement and motions round. The
/// distance is far below any that a plan can intend.
constexpr double on_wall_mm() {
  return 1e-6;
}

/// For each point of the moved object, whether it lies on the cut's wall.
std::vector<bool> on_wall(const std::vector<glm::dvec3>& points_mm, const CutWall& cut) {
  const glm::dmat4 still_from_moved = glm::inverse(cut.moved_from_still);
  std::vector<glm::dvec3> still_mm(points_mm.size());
  std::transform(points_mm.begin(), points_mm.end(), still_mm.begin(), [&](const glm::dvec3& p_mm) {
    return glm::dvec3(still_from_moved * glm::dvec4(p_mm, 1.0));
  });
  const std::vector<double> distances_mm = cut.wall.tree().distances_mm(still_mm);
  std::vector<bool> on(points_mm.size());
  for (std::size_t i = 0; i < on.size(); ++i) on[i] = distances_mm[i] <= on_wall_mm();
  return on;
}

constexpr std::size_t outer = std::numeric_limits<std::size_t>::max();

/// For each triangle, the number of the first cut on whose wall its corners lie, or `outer`.
std::vector<std::size_t> cuts_of(const brep::Triangles& surface, const std::vector<CutWall>& cuts) {
  std::vector<std::size_t> cut_of(surface.faces.size(), outer);
  for (std::size_t c = 0; c < cuts.size(); ++c) {
    const std::vector<bool> on = on_wall(surface.points_mm, cuts[c]);
    for (std::size_t f = 0; f < surface.faces.size(); ++f) {
      const auto& [i, j, k] = surface.faces[f];
      if (cut_of[f] == outer && on[i] && on[j] && on[k]) cut_of[f] = c;
    }
  }
  return cut_of;
}

}  // namespace

std::vector<convert::DeckSurface> cut_surfaces(const Object& object, const convert::Tetrahedra& tetrahedra) {
  const std::vector<convert::ElementFace> faces = convert::surface_faces(tetrahedra);
  if (object.walls.empty()) return {{"OUTER", faces}};
  const brep::Solid& solid = *object.mesh.within;
  const std::vector<std::size_t> cut_of = cuts_of(solid.triangles(), object.walls);
  std::vector<glm::dvec3> middles_mm;
  for (const convert::ElementFace& face : faces) {
    const auto [a, b, c] = convert::corners_of(tetrahedra, face);
    middles_mm.push_back((tetrahedra.nodes_mm[a] + tetrahedra.nodes_mm[b] + tetrahedra.nodes_mm[c]) / 3.0);
  }
  const std::vector<brep::Foot> feet = solid.tree().feet(middles_mm);

  std::vector<convert::DeckSurface> surfaces{{"OUTER", {}}};
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::size_t cut = cut_of[feet[f].face];
    const std::string name = cut == outer ? "OUTER" : "CUT_" + object.walls[cut].mask;
    auto of_name = std::find_if(surfaces.begin(), surfaces.end(),
                                [&](const convert::DeckSurface& known) { return known.name == name; });
    if (of_name == surfaces.end()) of_name = surfaces.insert(surfaces.end(), {name, {}});
    of_name->faces.push_back(faces[f]);
  }
  std::erase_if(surfaces, [](const convert::DeckSurface& empty) { return empty.faces.empty(); });
  return surfaces;
}

}  // namespace octotomy::planner
