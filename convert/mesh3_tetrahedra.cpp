// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/mesh3_tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "brep/distance.h"
#include "convert/deck.h"
#include "convert/improve_tetrahedra.h"

// 1 Mesh_3 refines a Delaunay triangulation until the surface's facets and the cells are of the sizes asked
//   for, and exudes slivers.
// 2 Its surface's nodes lie on the given one, so that its facets are chords of it: it has lost volume where
//   the surface is convex and won some where it is hollow. Every node of the surface moves along its normal
//   by the same length, the loss by the area; that is microns, or something else was lost.
// 3 Flat elements are mended by moving nodes (improve_tetrahedra.h).
// 4 The answer is believed where the volumes are positive and their sum is the surface's, and where each
//   point of the given surface has the new one near: a thin spike that no cell met would be lost in silence.

namespace octotomy::convert {
namespace {

std::string text_of(double value) {
  std::ostringstream text;
  text << std::setprecision(3) << value;
  return text.str();
}

double length_of_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::length(glm::cross(b - a, c - a));
}

/// The radius of the ball about a triangle of the surface's mean area, were it equilateral.
double mean_triangle_radius_mm(const MesherInput& surface) {
  double area_mm2 = 0.0;
  for (const auto& [a, b, c] : surface.triangles)
    area_mm2 += 0.5 * length_of_normal(surface.points_mm[a], surface.points_mm[b], surface.points_mm[c]);
  const double side_mm =
      std::sqrt(area_mm2 / static_cast<double>(surface.triangles.size()) * 4.0 / std::sqrt(3.0));
  return side_mm / std::sqrt(3.0);
}

Mesh3Sizes sizes_of(const MesherInput& surface, const TetOptions& options) {
  const double radius_mm = mean_triangle_radius_mm(surface);
  Mesh3Sizes sizes{1.5 * radius_mm, 0.1 * radius_mm, 4.0 * radius_mm};
  // The largest tetrahedron in a ball of radius R has a volume of 8 R^3 / (9 sqrt 3).
  if (options.limit_volume)
    sizes.cell_mm = std::min(sizes.cell_mm, std::cbrt(options.max_volume_mm3 * 9.0 * std::sqrt(3.0) / 8.0));
  return sizes;
}

brep::Triangles surface_of(const Tetrahedra& tetrahedra) {
  brep::Triangles surface{tetrahedra.nodes_mm, {}};
  for (const ElementFace& face : surface_faces(tetrahedra))
    surface.faces.push_back(corners_of(tetrahedra, face));
  return surface;
}

/// Pass 2. Answers the length, positive outward. The volume is the area's integral to first order, so twice
/// gives it to second.
double restore_volume(Tetrahedra& tetrahedra, double volume_mm3) {
  const brep::Triangles surface = surface_of(tetrahedra);
  double moved_mm = 0.0;
  for (int i = 0; i < 2; ++i) {
    std::vector<glm::dvec3> normals(tetrahedra.nodes_mm.size(), glm::dvec3(0.0));
    double area_mm2 = 0.0;
    for (const auto& [a, b, c] : surface.faces) {
      const auto& p = tetrahedra.nodes_mm;
      const glm::dvec3 normal = glm::cross(p[b] - p[a], p[c] - p[a]);
      area_mm2 += 0.5 * glm::length(normal);
      for (const std::uint32_t v : {a, b, c}) normals[v] += normal;
    }
    const double by_mm = (volume_mm3 - quality(tetrahedra).volume_mm3) / area_mm2;
    for (const std::uint32_t v : tetrahedra.boundary_nodes)
      if (const double length = glm::length(normals[v]); length > 0.0)
        tetrahedra.nodes_mm[v] += by_mm / length * normals[v];
    moved_mm += by_mm;
  }
  return moved_mm;
}

struct Apart {
  double max_mm = 0.0;
  double p95_mm = 0.0;
};
Apart apart(std::vector<double> distances_mm) {
  std::sort(distances_mm.begin(), distances_mm.end());
  return {distances_mm.back(), distances_mm[distances_mm.size() * 95 / 100]};
}

std::vector<glm::dvec3> boundary_mm(const Tetrahedra& tetrahedra) {
  std::vector<glm::dvec3> points;
  for (const std::uint32_t v : tetrahedra.boundary_nodes) points.push_back(tetrahedra.nodes_mm[v]);
  return points;
}

/// A point of the given surface further than this from the new one stands on a detail that was lost: one
/// smaller than a facet.
double lost_mm(const Mesh3Sizes& sizes) {
  return sizes.facet_mm;
}
/// The share of the given surface's points that may be lost: thin spikes and needles of noise are, a part of
/// the bone is not.
constexpr double lost_share() {
  return 1e-3;
}

/// One try: its elements, if it came to any, and what is wrong with them; and points of the given surface
/// that it lost.
struct Try {
  MesherOutcome outcome;
  Tetrahedra made;
  std::vector<glm::dvec3> lost;
};

/// Passes 2 to 4 over what Mesh_3 made.
std::optional<std::string> finish(Try& t, const MesherInput& given, double surface_mm3,
                                  const Mesh3Sizes& sizes, const TetOptions& options) {
  const double moved_mm = restore_volume(t.made, surface_mm3);
  if (!(std::abs(moved_mm) <= sizes.distance_mm))
    return "misses the volume by as much as " + text_of(moved_mm) + " mm of the whole surface";
  ImproveOptions improving;
  improving.min_dihedral_deg = options.min_dihedral_deg;
  improving.surface_play_mm = sizes.distance_mm;
  improving.stop = options.stop;
  improve(t.made, improving);

  const std::vector<double> to_own_mm = brep::SurfaceTree(surface_of(t.made)).distances_mm(given.points_mm);
  for (std::size_t i = 0; i < to_own_mm.size(); ++i)
    if (to_own_mm[i] > lost_mm(sizes)) t.lost.push_back(given.points_mm[i]);
  const Apart own = apart(to_own_mm);
  const Apart nodes = apart(
      brep::SurfaceTree(brep::Triangles{given.points_mm, given.triangles}).distances_mm(boundary_mm(t.made)));
  t.made.findings.push_back("the surface is Mesh_3's own: its nodes are within " + text_of(nodes.max_mm) +
                            " mm of the given one, 95 % of whose points are within " + text_of(own.p95_mm) +
                            " mm of it, all within " + text_of(own.max_mm) + " mm");
  if (static_cast<double>(t.lost.size()) > lost_share() * static_cast<double>(to_own_mm.size()))
    return "loses details: " + std::to_string(t.lost.size()) + " of " + std::to_string(to_own_mm.size()) +
           " points of the given surface are over " + text_of(lost_mm(sizes)) +
           " mm from its own, the first at " + text_of(t.lost.front().x) + ", " + text_of(t.lost.front().y) +
           ", " + text_of(t.lost.front().z) + " mm";
  return fault_in_filling(t.made, surface_mm3, own_surface_volume_tolerance());
}

Try try_once(const MesherInput& surface, double surface_mm3, const Mesh3Sizes& sizes,
             const TetOptions& options) {
  Try t;
  t.outcome = run_mesh3(surface, sizes, {options.time_limit, options.memory_limit_bytes, options.stop});
  if (!t.outcome.failure && t.outcome.tetrahedra.empty())
    t.outcome.failure = "CGAL's Mesh_3 gave no tetrahedra";
  if (t.outcome.failure) return t;
  t.made.nodes_mm = std::move(t.outcome.points_mm);
  t.made.tets = std::move(t.outcome.tetrahedra);
  t.made.boundary_nodes = boundary_nodes(t.made.tets);
  t.made.method = "Mesh_3";
  if (const std::optional<std::string> fault = finish(t, surface, surface_mm3, sizes, options))
    t.outcome.failure = "CGAL's Mesh_3 " + *fault;
  return t;
}

}  // namespace

Mesh3Filling fill_by_mesh3(const MesherInput& given, double surface_mm3, const TetOptions& options) {
  constexpr int tries = 3;
  MesherInput surface = given;
  Mesh3Sizes sizes = sizes_of(surface, options);
  Mesh3Filling filling;
  for (int i = 0; i < tries; ++i) {
    Try t = try_once(surface, surface_mm3, sizes, options);
    if (!t.outcome.failure) {
      filling.tetrahedra = std::move(t.made);
      return filling;
    }
    filling.findings.push_back(*t.outcome.failure);
    // Smaller elements help where something was missed, not where time or memory was short.
    if (t.made.tets.empty()) break;
    surface.holes_mm.insert(surface.holes_mm.end(), t.lost.begin(), t.lost.end());
    sizes.distance_mm *= 0.5;
    sizes.facet_mm *= 0.7;
  }
  return filling;
}

}  // namespace octotomy::convert
