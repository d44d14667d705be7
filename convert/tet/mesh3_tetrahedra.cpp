// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/mesh3_tetrahedra.h"

#include <algorithm>
#include <cmath>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "convert/tet/element_faces.h"
#include "convert/tet/improve_tetrahedra.h"
#include "convert/tet/sharp_edges.h"
#include "voxel/space/rounded.h"

// 1 Mesh_3 refines a Delaunay triangulation until facets and cells have the requested sizes, and exudes
//   slivers. Nodes beside sharp edges of the given surface move onto these (sharp_edges.h).
// 2 The nodes of its surface lie on the given one, so its facets are chords: they lose volume on a convex
//   surface and gain some on a hollow one. Every node of the surface, except those of flat faces and sharp
//   edges, moves along its normal by the same share of the distance allowed there between a facet's middle
//   and the given surface. The share is at most 1: a larger one would mean that something else was lost.
// 3 Nodes move to mend flat elements (improve_tetrahedra.h).
// 4 The answer counts only if the volumes are positive, their sum is the surface's, each point of the given
//   surface is near the new surface, and little of the volume lies outside. Without these checks the loss of
//   a thin spike or wall that no cell met would go unnoticed.

namespace octotomy::convert {
namespace {

using voxel::rounded;

/// The radius R of a ball whose largest inscribed tetrahedron, of the volume 8 R^3 / (9 sqrt 3), has 0.9
/// times the given volume. The rest is left for passes 2 and 3, which may enlarge an element.
double radius_of_volume(double mm3) {
  constexpr double before_moves = 0.9;
  return std::cbrt(before_moves * mm3 * 9.0 * std::sqrt(3.0) / 8.0);
}

/// The largest radius of a facet's ball, as a multiple of the side of the given triangles there: 1.5 times
/// the radius that an equilateral triangle has.
double facet_radius_by_side() {
  return 1.5 / std::sqrt(3.0);
}

/// For each node of the surface: its normal, not of unit length, and a third of the area of its triangles.
struct NodeNormals {
  std::vector<glm::dvec3> normals;
  std::vector<double> area_mm2;
};
NodeNormals node_normals(const Tetrahedra& tetrahedra, const brep::Triangles& surface) {
  NodeNormals at{std::vector<glm::dvec3>(tetrahedra.nodes_mm.size(), glm::dvec3(0.0)),
                 std::vector<double>(tetrahedra.nodes_mm.size(), 0.0)};
  const auto& p = tetrahedra.nodes_mm;
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 normal = glm::cross(p[b] - p[a], p[c] - p[a]);
    for (const std::uint32_t v : {a, b, c}) {
      at.normals[v] += normal;
      at.area_mm2[v] += glm::length(normal) / 6.0;
    }
  }
  return at;
}

/// Moves the nodes of inverted elements back to where they were, until no element is inverted.
void undo_inversions(Tetrahedra& tetrahedra, const std::vector<glm::dvec3>& before_mm) {
  for (bool turned = true; turned;) {
    turned = false;
    for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
      if (six_volumes(corners_mm(tetrahedra, t)) > 0.0) continue;
      for (const std::uint32_t v : tetrahedra.tets[t]) {
        turned = turned || tetrahedra.nodes_mm[v] != before_mm[v];
        tetrahedra.nodes_mm[v] = before_mm[v];
      }
    }
  }
}

/// Pass 2: moves nodes of the surface by a share of their play, which is in the order of `boundary_nodes`.
/// Returns the share, positive outward. Needs several rounds, because the volume is linear in the share to
/// first order only and some nodes move back.
double restore_volume(Tetrahedra& tetrahedra, double volume_mm3, const std::vector<double>& play_mm) {
  constexpr int rounds = 4;
  const brep::Triangles surface = surface_of(tetrahedra);
  double moved = 0.0;
  for (int i = 0; i < rounds; ++i) {
    const NodeNormals at = node_normals(tetrahedra, surface);
    double whole_play_mm3 = 0.0;
    for (std::size_t k = 0; k < play_mm.size(); ++k)
      whole_play_mm3 += play_mm[k] * at.area_mm2[tetrahedra.boundary_nodes[k]];
    if (!(whole_play_mm3 > 0.0)) return moved;
    const double by = (volume_mm3 - quality(tetrahedra).volume_mm3) / whole_play_mm3;
    moved += by;
    if (!(std::abs(moved) <= 1.0)) return moved;
    const std::vector<glm::dvec3> before_mm = tetrahedra.nodes_mm;
    for (std::size_t k = 0; k < play_mm.size(); ++k) {
      const std::uint32_t v = tetrahedra.boundary_nodes[k];
      if (const double length = glm::length(at.normals[v]); length > 0.0)
        tetrahedra.nodes_mm[v] += by * play_mm[k] / length * at.normals[v];
    }
    undo_inversions(tetrahedra, before_mm);
  }
  return moved;
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

/// The share of the given surface's triangles that may be lost: it allows the loss of needles of noise, but
/// not of a part of the bone.
constexpr double lost_share() {
  return 1e-3;
}

/// The largest share of the volume that may lie outside the given surface, where chords cross hollows.
constexpr double misplaced_share() {
  return 0.1;
}

/// One try: how the mesher ended, its elements if there are any, and the points of the given surface that it
/// lost.
struct Try {
  MesherOutcome outcome;
  Tetrahedra made;
  std::vector<std::uint32_t> lost;
};

/// The parts of a surface connected by points.
struct Shells {
  std::vector<std::uint32_t> of_triangle;  ///< a point of the shell, the same for all of its triangles
  std::vector<std::size_t> triangles;      ///< number of triangles of the shell, by that point
  std::vector<double> mm3;                 ///< volume of the shell, by that point; negative if inside out
};

Shells shells_of(const MesherInput& surface) {
  const std::size_t points = surface.points_mm.size();
  brep::DisjointSets sets(points);
  for (const auto& [a, b, c] : surface.triangles) {
    sets.join(a, b);
    sets.join(a, c);
  }
  Shells shells{{}, std::vector<std::size_t>(points, 0), std::vector<double>(points, 0.0)};
  for (const auto& [a, b, c] : surface.triangles) {
    const std::uint32_t shell = sets.set_of(a);
    const glm::dvec3& tip = surface.points_mm[shell];
    shells.of_triangle.push_back(shell);
    ++shells.triangles[shell];
    shells.mm3[shell] += glm::dot(glm::cross(surface.points_mm[a] - tip, surface.points_mm[b] - tip),
                                  surface.points_mm[c] - tip) /
                         6.0;
  }
  return shells;
}

/// The given surface, and the largest sizes of facets at its points, which hold for every try.
struct Given {
  const MesherInput& surface;
  double volume_mm3 = 0.0;
  Shells shells;
  std::vector<double> facet_mm;
  brep::SurfaceTree tree;
};

/// The distance by which each node of the surface may move: the largest allowed distance between a facet's
/// middle and the surface there.
std::vector<double> play_mm(const Given& given, const std::vector<brep::Foot>& feet) {
  std::vector<double> play;
  for (const brep::Foot& foot : feet) {
    double facet_mm = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      facet_mm +=
          foot.weights[static_cast<int>(i)] * given.facet_mm[given.surface.triangles[foot.face].at(i)];
    play.push_back(Mesh3Sizes{}.distance * facet_mm);
  }
  return play;
}

/// Selects shells whose triangles are all lost, smallest first, as long as their total volume stays within
/// the tolerance: films and specks too thin for an element of their triangles' size. Adds a finding.
std::vector<bool> lost_specks(Try& t, const Given& given, const std::vector<bool>& is_gone) {
  const Shells& shells = given.shells;
  std::vector<std::size_t> gone(shells.mm3.size(), 0);
  for (std::size_t f = 0; f < is_gone.size(); ++f) gone[shells.of_triangle[f]] += is_gone[f];
  std::vector<std::uint32_t> specks;
  for (std::uint32_t s = 0; s < gone.size(); ++s)
    if (gone[s] > 0 && gone[s] == shells.triangles[s]) specks.push_back(s);
  std::stable_sort(specks.begin(), specks.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::abs(shells.mm3[a]) < std::abs(shells.mm3[b]);
  });
  std::vector<bool> is_speck(gone.size(), false);
  double sum_mm3 = 0.0;
  std::size_t count = 0;
  for (; count < specks.size(); ++count) {
    const double more_mm3 = std::abs(shells.mm3[specks[count]]);
    if (sum_mm3 + more_mm3 > own_surface_volume_tolerance() * given.volume_mm3) break;
    sum_mm3 += more_mm3;
    is_speck[specks[count]] = true;
  }
  if (count > 0)
    t.made.findings.push_back("left out " + std::to_string(count) +
                              " closed shells too thin for an element of their triangles' size, " +
                              rounded(sum_mm3) + " mm3 together, the thinnest at " +
                              rounded(given.surface.points_mm[specks.front()]) + " mm");
  return is_speck;
}

/// Finds the points of the given surface that are further from the new surface than a facet's size: they lie
/// on a lost detail. Returns a reason if too much is lost: the tip of a spike and specks may be lost, other
/// triangles may not.
std::optional<std::string> lost_details(Try& t, const Given& given, const std::vector<double>& to_own_mm) {
  std::vector<bool> is_lost(to_own_mm.size(), false);
  for (std::uint32_t i = 0; i < to_own_mm.size(); ++i) is_lost[i] = to_own_mm[i] > given.facet_mm[i];
  const auto& triangles = given.surface.triangles;
  std::vector<bool> is_gone(triangles.size());
  for (std::size_t f = 0; f < triangles.size(); ++f)
    is_gone[f] =
        std::all_of(triangles[f].begin(), triangles[f].end(), [&](std::uint32_t v) { return is_lost[v]; });
  const std::vector<bool> is_speck = lost_specks(t, given, is_gone);
  std::size_t gone = 0;
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    if (is_speck[given.shells.of_triangle[f]])
      for (const std::uint32_t v : triangles[f]) is_lost[v] = false;
    else
      gone += is_gone[f];
  }
  for (std::uint32_t i = 0; i < is_lost.size(); ++i)
    if (is_lost[i]) t.lost.push_back(i);
  if (static_cast<double>(gone) <= lost_share() * static_cast<double>(triangles.size())) return std::nullopt;
  const glm::dvec3& first_mm = given.surface.points_mm[t.lost.front()];
  return "lost details: " + std::to_string(gone) + " of " + std::to_string(triangles.size()) +
         " triangles of the given surface are further from the new surface than the size of a facet, the "
         "first at " +
         rounded(first_mm) + " mm";
}

/// If a thin wall between the given points is lost, pass 2 has thickened the other parts until the volume is
/// the given one. So this measures the volume outside the given solid, by four points of each element, and
/// returns a reason if it is too large.
std::optional<std::string> misplaced(const Tetrahedra& made, const Given& given) {
  // Each point of Hammer's formula for quadratic functions weighs one corner by `own` and the three others by
  // `others`.
  constexpr double own = 0.5854101966249685, others = 0.1381966011250105;
  std::vector<glm::dvec3> points_mm;
  for (std::size_t t = 0; t < made.tets.size(); ++t) {
    const TetCorners p_mm = corners_mm(made, t);
    for (const glm::dvec3& corner_mm : p_mm)
      points_mm.push_back(others * (p_mm[0] + p_mm[1] + p_mm[2] + p_mm[3]) + (own - others) * corner_mm);
  }
  const std::vector<std::uint8_t> inside = given.tree.inside(points_mm);
  double outside_mm3 = 0.0;
  for (std::size_t i = 0; i < inside.size(); ++i)
    if (inside[i] == 0) outside_mm3 += six_volumes(corners_mm(made, i / 4)) / 24.0;
  if (outside_mm3 <= misplaced_share() * given.volume_mm3) return std::nullopt;
  return "put " + rounded(100.0 * outside_mm3 / given.volume_mm3) +
         " % of the volume outside of the given surface: walls are thinner than elements";
}

/// How far nodes may move: 0 for nodes on flat faces, because the facets there lose no volume.
std::vector<double> play_off_flats_mm(const Tetrahedra& made, std::vector<double> play_mm) {
  constexpr double flat_cosine = 0.99985;  // a degree
  const brep::Triangles surface = surface_of(made);
  const NodeNormals at = node_normals(made, surface);
  std::vector<bool> is_curved(made.nodes_mm.size(), false);
  const auto& p = made.nodes_mm;
  for (const auto& [a, b, c] : surface.faces) {
    const glm::dvec3 normal = glm::cross(p[b] - p[a], p[c] - p[a]);
    for (const std::uint32_t v : {a, b, c})
      if (glm::dot(normal, at.normals[v]) < flat_cosine * glm::length(normal) * glm::length(at.normals[v]))
        is_curved[v] = true;
  }
  for (std::size_t k = 0; k < play_mm.size(); ++k)
    if (!is_curved[made.boundary_nodes[k]]) play_mm[k] = 0.0;
  return play_mm;
}

/// Passes 2 to 4 over the elements of Mesh_3.
std::optional<std::string> finish(Try& t, const Given& given, const TetOptions& options) {
  ImproveOptions improving;
  const brep::Triangles surface{given.surface.points_mm, given.surface.triangles};
  const std::vector<std::uint32_t> on_edges =
      put_on_sharp_edges(t.made, {surface, given.tree}, fit_dihedral_deg());
  improving.surface_play_mm = play_mm(given, given.tree.feet(boundary_mm(t.made)));
  for (std::size_t k = 0; k < t.made.boundary_nodes.size(); ++k)
    if (std::binary_search(on_edges.begin(), on_edges.end(), t.made.boundary_nodes[k]))
      improving.surface_play_mm[k] = 0.0;
  improving.min_dihedral_deg = options.min_dihedral_deg;
  improving.progress.stop = options.progress.stop;
  // Surface nodes that move to mend an element change the volume again, by less each time.
  constexpr int rounds = 3;
  std::optional<std::string> fault;
  for (int i = 0; i < rounds && (i == 0 || fault); ++i) {
    const double moved =
        restore_volume(t.made, given.volume_mm3, play_off_flats_mm(t.made, improving.surface_play_mm));
    if (!(std::abs(moved) <= 1.0))
      return "misses the volume by " + rounded(std::abs(moved)) +
             " times the largest amount that its facets may cut off";
    improve(t.made, improving);
    fault = fault_in_filling(t.made, given.volume_mm3, own_surface_volume_tolerance());
  }

  const std::vector<double> to_own_mm =
      brep::SurfaceTree(surface_of(t.made)).distances_mm(given.surface.points_mm);
  const Apart own = apart(to_own_mm);
  const Apart nodes = apart(given.tree.distances_mm(boundary_mm(t.made)));
  t.made.findings.push_back("Mesh_3 made a new surface: its nodes are within " + rounded(nodes.max_mm) +
                            " mm of the given one; 95 % of the given surface's points are within " +
                            rounded(own.p95_mm) + " mm of the new surface, all within " +
                            rounded(own.max_mm) + " mm");
  if (std::optional<std::string> lost = lost_details(t, given, to_own_mm)) return lost;
  if (std::optional<std::string> lost = misplaced(t.made, given)) return lost;
  return fault;
}

Try try_once(const MesherInput& surface, const Given& given, const TetOptions& options) {
  Mesh3Sizes sizes;
  if (options.max_volume_mm3) sizes.max_cell_mm = radius_of_volume(*options.max_volume_mm3);
  Try t;
  t.outcome = run_mesh3(surface, sizes, {options.time_limit, options.memory_limit_bytes, options.progress});
  if (!t.outcome.failure && t.outcome.tetrahedra.empty())
    t.outcome.failure = "CGAL's Mesh_3 made no tetrahedra";
  if (t.outcome.failure) return t;
  t.made.nodes_mm = std::move(t.outcome.points_mm);
  t.made.tets = std::move(t.outcome.tetrahedra);
  t.made.boundary_nodes = boundary_nodes(t.made.tets);
  t.made.method = "Mesh_3";
  if (const std::optional<std::string> fault = finish(t, given, options))
    t.outcome.failure = "CGAL's Mesh_3 " + *fault;
  return t;
}

}  // namespace

Mesh3Filling fill_by_mesh3(const MesherInput& given, const SizeLimits& limits, double surface_mm3,
                           const TetOptions& options) {
  constexpr int tries = 4;
  // Facets may not have longer sides than the refinements require.
  SizeLimits by_facets = limits;
  for (double& most_mm : by_facets.most_mm) most_mm /= std::sqrt(3.0) * facet_radius_by_side();
  SurfaceSizes sizes(given, Mesh3Sizes{}.grading, by_facets);
  sizes.scale(facet_radius_by_side());
  const Given first{given, surface_mm3, shells_of(given), sizes.at_points_mm(),
                    brep::SurfaceTree(brep::Triangles{given.points_mm, given.triangles})};
  MesherInput surface = given;
  Mesh3Filling filling;
  for (int i = 0; i < tries; ++i) {
    surface.sizes_mm = sizes.at_points_mm();
    Try t = try_once(surface, first, options);
    if (!t.outcome.failure) {
      filling.tetrahedra = std::move(t.made);
      return filling;
    }
    filling.findings.push_back(*t.outcome.failure);
    filling.code = t.outcome.code;
    // Smaller elements help if something was missed, not if time or memory was short.
    if (t.made.tets.empty()) break;
    if (t.lost.empty()) sizes.scale(0.7);
    sizes.halve(t.lost);
    for (const std::uint32_t v : sizes.thinned(t.lost)) surface.holes_mm.push_back(given.points_mm[v]);
  }
  return filling;
}

}  // namespace octotomy::convert
