// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 collect the sides of all triangles by edge; 2 count edges, fans, shells and duplicates from these; 3
// count degenerate triangles; 4 find which shells enclose each shell; 5 find the triangles that intersect.
// Works on triangles instead of halfedges, so that non-manifold meshes can be examined.
#include "brep/mesh/health.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/morton_tree.h"
#include "brep/mesh/self_intersections.h"
#include "brep/mesh/shell_places.h"
#include "brep/mesh/sides.h"
#include "brep/mesh/sure_plane.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr std::size_t crossing_limit = 100;

Kernel::Point_3 exact(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

void check_points(const Triangles& triangles) {
  const auto is_sound = [&](std::uint32_t v) {
    return v < triangles.points_mm.size() && std::isfinite(triangles.points_mm[v].x) &&
           std::isfinite(triangles.points_mm[v].y) && std::isfinite(triangles.points_mm[v].z);
  };
  const auto is_sound_triangle = [&](const std::array<std::uint32_t, 3>& face) {
    return is_sound(face[0]) && is_sound(face[1]) && is_sound(face[2]);
  };
  using Range = tbb::blocked_range<std::size_t>;
  const std::size_t count = triangles.faces.size();
  const std::size_t first = tbb::parallel_reduce(
      Range(0, count, 4096), count,
      [&](const Range& range, std::size_t found) {
        for (std::size_t f = range.begin(); f < std::min(range.end(), found); ++f)
          if (!is_sound_triangle(triangles.faces[f])) return f;
        return found;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
  if (first == count) return;
  for (const std::uint32_t v : triangles.faces[first])
    if (v >= triangles.points_mm.size())
      throw Error(ErrorCode::Input, "triangle " + std::to_string(first) + " refers to point " +
                                        std::to_string(v) + " of " +
                                        std::to_string(triangles.points_mm.size()));
  throw Error(ErrorCode::Input, "triangle " + std::to_string(first) + " has a point that is not finite");
}

/// The first triangle of each finding.
struct Offenders {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t boundary = none, nonmanifold_edge = none, nonmanifold_vertex = none, misoriented = none,
                degenerate = none, duplicate = none, misplaced = none;

  static void note(std::uint32_t& first, std::uint32_t triangle) { first = std::min(first, triangle); }
};

/// The counts of one thread over the edges that it visits.
struct EdgeTally {
  std::size_t edges = 0, open = 0, nonmanifold = 0, misoriented = 0, duplicates = 0;
  Offenders first;
  /// The sides of edges with more than two triangles, or with two of the same direction.
  std::vector<Side> irregular;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> thirds;  ///< scratch

  void add(const EdgeTally& other) {
    edges += other.edges;
    open += other.open;
    nonmanifold += other.nonmanifold;
    misoriented += other.misoriented;
    duplicates += other.duplicates;
    Offenders::note(first.boundary, other.first.boundary);
    Offenders::note(first.nonmanifold_edge, other.first.nonmanifold_edge);
    Offenders::note(first.misoriented, other.first.misoriented);
    Offenders::note(first.duplicate, other.first.duplicate);
    irregular.insert(irregular.end(), other.irregular.begin(), other.irregular.end());
  }
};

/// Counts the pairs of triangles with the same three points among those at one edge.
void count_duplicates(const Triangles& triangles, const Side* begin, const Side* end, EdgeTally& tally) {
  // A triangle is counted at the edge of its two lowest points.
  auto& thirds = tally.thirds;
  thirds.clear();
  for (const Side* side = begin; side != end; ++side) {
    const std::uint32_t third = triangles.faces[side->corner / 3][previous_corner(side->corner) % 3];
    if (third >= side->high) thirds.emplace_back(third, side->corner / 3);
  }
  if (thirds.size() < 2) return;
  std::sort(thirds.begin(), thirds.end());
  // A triangle that repeats a point has an edge twice, but is counted once.
  thirds.erase(std::unique(thirds.begin(), thirds.end()), thirds.end());
  std::size_t earlier = 0;
  for (std::size_t i = 1; i < thirds.size(); ++i) {
    earlier = thirds[i].first == thirds[i - 1].first ? earlier + 1 : 0;
    tally.duplicates += earlier;
    if (earlier == 1) Offenders::note(tally.first.duplicate, thirds[i - 1].second);
  }
}

/// Visits all edges. Sets `opposite` for edges of two triangles with opposite directions: the other
/// triangle's side.
EdgeTally visit_edges(const Triangles& triangles, std::vector<std::uint32_t>& opposite) {
  opposite.assign(3 * triangles.faces.size(), Linked::none);
  tbb::enumerable_thread_specific<EdgeTally> tallies;
  each_edge_in_parallel(triangles, [&](const Side* begin, const Side* end) {
    EdgeTally& tally = tallies.local();
    ++tally.edges;
    const std::uint32_t first = begin->corner / 3;
    assert(first < triangles.faces.size());
    if (end - begin == 1) {
      ++tally.open;
      Offenders::note(tally.first.boundary, first);
      return;
    }
    count_duplicates(triangles, begin, end, tally);
    if (end - begin == 2 && begin[0].upward != begin[1].upward) {
      opposite[begin[0].corner] = begin[1].corner;
      opposite[begin[1].corner] = begin[0].corner;
      return;
    }
    tally.irregular.insert(tally.irregular.end(), begin, end);
    if (end - begin > 2) {
      ++tally.nonmanifold;
      Offenders::note(tally.first.nonmanifold_edge, first);
    } else {
      ++tally.misoriented;
      Offenders::note(tally.first.misoriented, first);
    }
  });
  EdgeTally whole;
  for (const EdgeTally& tally : tallies) whole.add(tally);
  return whole;
}

/// The number of fans at each point: sets of triangles joined by edges at the point.
std::vector<std::uint32_t> count_fans(const Triangles& triangles, const std::vector<std::uint32_t>& opposite,
                                      const std::vector<Side>& irregular) {
  std::vector<std::uint32_t> count(triangles.points_mm.size(), 0);
  const auto add = [&](std::uint32_t corner) { ++count[triangles.faces[corner / 3][corner % 3]]; };
  if (irregular.empty()) {
    each_fan(opposite, add, [](std::uint32_t) {});
    return count;
  }
  DisjointSets fans(opposite.size());
  std::uint32_t first = 0;
  each_fan(
      opposite, [&](std::uint32_t corner) { first = corner; },
      [&](std::uint32_t corner) { fans.join(first, corner); });
  each_edge(irregular, [&](const Side* begin, const Side* end) {
    for (const Side* other = begin + 1; other != end; ++other) {
      const bool same_way = begin->upward == other->upward;
      fans.join(begin->corner, same_way ? other->corner : next_corner(other->corner));
      fans.join(next_corner(begin->corner), same_way ? next_corner(other->corner) : other->corner);
    }
  });
  for (std::uint32_t corner = 0; corner < opposite.size(); ++corner)
    if (fans.set_of(corner) == corner) add(corner);
  return count;
}

/// The shell of each triangle (triangles joined by edges), identified by its first triangle.
std::vector<std::uint32_t> shells_of(const std::vector<std::uint32_t>& opposite,
                                     const std::vector<Side>& irregular) {
  DisjointSets shells(opposite.size() / 3);
  for (std::uint32_t side = 0; side < opposite.size(); ++side)
    if (opposite[side] != Linked::none && side < opposite[side]) shells.join(side / 3, opposite[side] / 3);
  each_edge(irregular, [&](const Side* begin, const Side* end) {
    for (const Side* other = begin + 1; other != end; ++other)
      shells.join(begin->corner / 3, other->corner / 3);
  });
  std::vector<std::uint32_t> shell(opposite.size() / 3);
  for (std::uint32_t f = 0; f < shell.size(); ++f) shell[f] = shells.set_of(f);
  return shell;
}

/// The number of parts that are connected by points.
std::size_t count_components(const Triangles& triangles, const std::vector<std::uint32_t>& fan_count) {
  DisjointSets bodies(triangles.points_mm.size());
  for (const auto& face : triangles.faces) {
    bodies.join(face[0], face[1]);
    bodies.join(face[1], face[2]);
  }
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < fan_count.size(); ++v) count += fan_count[v] > 0 && bodies.set_of(v) == v;
  return count;
}

/// Fills the counts of edges and vertices. Returns the shell of each triangle, identified by its first
/// triangle.
std::vector<std::uint32_t> count_connections(const Triangles& triangles, Health& health,
                                             Offenders& offenders) {
  std::vector<std::uint32_t> opposite;
  const EdgeTally edges = visit_edges(triangles, opposite);
  offenders = edges.first;
  health.boundary_edges = edges.open;
  health.nonmanifold_edges = edges.nonmanifold;
  health.misoriented_edges = edges.misoriented;
  health.duplicate_faces = edges.duplicates;

  const std::vector<std::uint32_t> fan_count = count_fans(triangles, opposite, edges.irregular);
  health.vertices = triangles.points_mm.size();
  for (const std::uint32_t count : fan_count) {
    if (count == 0) ++health.unused_vertices;
    if (count > 1) ++health.nonmanifold_vertices;
  }
  for (std::uint32_t c = 0; health.nonmanifold_vertices > 0 && c < opposite.size(); ++c)
    if (fan_count[triangles.faces[c / 3][c % 3]] > 1) Offenders::note(offenders.nonmanifold_vertex, c / 3);

  std::vector<std::uint32_t> shell = shells_of(opposite, edges.irregular);
  for (std::uint32_t f = 0; f < shell.size(); ++f) health.shells += shell[f] == f;
  // If each point has one fan, parts connected by points are also connected by edges.
  health.components =
      health.nonmanifold_vertices == 0 ? health.shells : count_components(triangles, fan_count);
  health.faces = triangles.faces.size();
  health.euler = static_cast<long>(health.vertices - health.unused_vertices) -
                 static_cast<long>(edges.edges) + static_cast<long>(health.faces);
  return shell;
}

/// For each point in use, the first point in use at its position; for other points, their own number.
std::vector<std::uint32_t> first_in_use(const Triangles& triangles) {
  std::vector<std::uint8_t> used(triangles.points_mm.size(), 0);
  for (const auto& face : triangles.faces)
    for (const std::uint32_t v : face) used[v] = 1;
  if (std::find(used.begin(), used.end(), 0) == used.end()) return first_equal_points(triangles.points_mm);
  std::vector<std::uint32_t> in_use;
  std::vector<glm::dvec3> points_mm;
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    in_use.push_back(v);
    points_mm.push_back(triangles.points_mm[v]);
  }
  const std::vector<std::uint32_t> place = first_equal_points(points_mm);
  std::vector<std::uint32_t> first(used.size());
  std::iota(first.begin(), first.end(), 0u);
  for (std::size_t i = 0; i < in_use.size(); ++i) first[in_use[i]] = in_use[place[i]];
  return first;
}

/// Counts points that coincide with others, and the boundary edges that merging these would close.
void count_coincident(const Triangles& triangles, const std::vector<std::uint32_t>& first, Health& health) {
  for (std::uint32_t v = 0; v < first.size(); ++v) health.coincident_points += first[v] != v;
  if (health.coincident_points == 0 || health.boundary_edges == 0) return;
  Triangles welded{triangles.points_mm, {}};
  for (const auto& face : triangles.faces)
    welded.faces.push_back({first[face[0]], first[face[1]], first[face[2]]});
  std::size_t open = 0;
  each_edge(sorted_sides(welded), [&](const Side* begin, const Side* end) {
    open += end - begin == 1 && begin->low != begin->high;
  });
  health.unwelded_edges = health.boundary_edges - std::min(open, health.boundary_edges);
}

/// Whether three points certainly span a triangle, by its three projections.
bool surely_has_area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = b - a, v = c - a;
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    const double one = u[i] * v[j], other = u[j] * v[i];
    if (sure_sign(one - other, std::abs(one) + std::abs(other)) != 0) return true;
  }
  return false;
}

/// Marks triangles without area, exactly.
std::vector<std::uint8_t> mark_degenerate(const Triangles& triangles, Health& health, Offenders& offenders) {
  std::vector<std::uint8_t> degenerate(triangles.faces.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, degenerate.size(), 4096), [&](const auto& range) {
    for (std::size_t f = range.begin(); f != range.end(); ++f) {
      const auto& v = triangles.faces[f];
      const glm::dvec3 &a = triangles.points_mm[v[0]], &b = triangles.points_mm[v[1]],
                       &c = triangles.points_mm[v[2]];
      degenerate[f] = !surely_has_area(a, b, c) && CGAL::collinear(exact(a), exact(b), exact(c));
    }
  });
  for (std::size_t f = 0; f < degenerate.size(); ++f) {
    if (degenerate[f] == 0) continue;
    ++health.degenerate_faces;
    Offenders::note(offenders.degenerate, static_cast<std::uint32_t>(f));
  }
  return degenerate;
}

/// The total volume, and whether every shell would be correct if all triangles were reversed.
struct PlacedShells {
  double volume_mm3 = 0.0;
  bool all_face_inward = false;
  std::size_t overlapping = 0;  ///< outward shells whose probe lies within other outward shells
};

/// Counts misplaced shells: the windings of the shells around a shell must add up to zero if it faces
/// outward, to one if it faces inward. Needs a closed, manifold, consistently wound mesh, and a tree if there
/// are several shells.
PlacedShells place_shells(const Triangles& triangles, const std::vector<std::uint32_t>& first,
                          const std::vector<std::uint32_t>& shell, const MortonTree* tree, Health& health,
                          Offenders& offenders) {
  assert(health.closed && health.nonmanifold_edges == 0 && health.misoriented_edges == 0);
  PlacedShells placed{0.0, true, 0};
  for (const ShellPlace& place : shell_places({triangles, first, shell}, tree)) {
    placed.volume_mm3 += place.volume_mm3;
    // Reversing all triangles changes the signs of volume and winding.
    placed.all_face_inward = placed.all_face_inward && place.volume_mm3 != 0.0 &&
                             place.winding == (place.volume_mm3 < 0.0 ? 0 : -1);
    if (place.winding == (place.volume_mm3 > 0.0 ? 0 : 1)) continue;
    ++health.misplaced_shells;
    placed.overlapping += place.volume_mm3 > 0.0 && place.winding > 0;
    Offenders::note(offenders.misplaced, place.shell);
  }
  return placed;
}

void test_intersections(const Triangles& triangles, const MortonTree& tree,
                        const std::vector<std::uint8_t>& degenerate, Health& health) {
  const SelfIntersections found = self_intersections({triangles, tree, degenerate, crossing_limit});
  health.intersections_tested = true;
  health.self_intersections = found.count;
  for (const auto& [f, g] : found.first)
    health.crossing.emplace_back(static_cast<int>(f), static_cast<int>(g));
}

/// The position of a triangle's middle: " at (12.5, -80.25, 3) mm".
std::string place_of(const Triangles& triangles, std::uint32_t triangle) {
  assert(triangle < triangles.faces.size());
  const auto& [a, b, c] = triangles.faces[triangle];
  const glm::dvec3 middle = (triangles.points_mm[a] + triangles.points_mm[b] + triangles.points_mm[c]) / 3.0;
  std::array<char, 96> place{};
  std::snprintf(place.data(), place.size(), " at (%.6g, %.6g, %.6g) mm", middle.x, middle.y, middle.z);
  return place.data();
}

void tell(const Triangles& triangles, Health& health, const Offenders& offenders,
          const PlacedShells& placed) {
  const auto add = [&](Defect defect, std::string finding) {
    if (!health.first_defect) health.first_defect = defect;
    health.findings.push_back(std::move(finding));
  };
  const auto say = [&](Defect defect, std::size_t count, const std::string& what, std::uint32_t first) {
    if (count > 0)
      add(defect, std::to_string(count) + " " + what + " (first: " + "triangle " + std::to_string(first) +
                      place_of(triangles, first) + ")");
  };
  if (health.faces == 0) add(Defect::NoTriangles, "no triangles");
  say(Defect::Open, health.boundary_edges, "edges with one triangle: the surface is open",
      offenders.boundary);
  if (health.unwelded_edges > 0)
    add(Defect::Open, "unwelded: " + std::to_string(health.unwelded_edges) + " of " +
                          std::to_string(health.boundary_edges) + " open edges close when welded, because " +
                          std::to_string(health.coincident_points) + " points coincide with others");
  say(Defect::NonmanifoldEdge, health.nonmanifold_edges, "edges with more than two triangles",
      offenders.nonmanifold_edge);
  say(Defect::NonmanifoldVertex, health.nonmanifold_vertices,
      "vertices where more than one fan of triangles meets", offenders.nonmanifold_vertex);
  say(Defect::Misoriented, health.misoriented_edges, "edges whose triangles wind against each other",
      offenders.misoriented);
  say(Defect::Degenerate, health.degenerate_faces, "triangles without area", offenders.degenerate);
  say(Defect::Duplicate, health.duplicate_faces, "pairs of triangles with the same points",
      offenders.duplicate);
  const bool is_placed = health.closed && health.nonmanifold_edges == 0 && health.misoriented_edges == 0;
  if (is_placed && placed.all_face_inward) {
    add(Defect::InsideOut,
        "the whole surface faces inward, so that its volume is " + std::to_string(placed.volume_mm3) +
            " mm3: turn its triangles over (first: " + "triangle " + std::to_string(offenders.misplaced) +
            place_of(triangles, offenders.misplaced) + ")");
  } else {
    say(Defect::MisplacedShell, health.misplaced_shells,
        placed.overlapping == health.misplaced_shells
            ? "shells that overlap: they lie within others that face outward, too"
            : "shells that face the wrong way for the shells around them",
        offenders.misplaced);
    if (is_placed && !(placed.volume_mm3 > 0.0))
      add(Defect::InsideOut, "the volume is " + std::to_string(placed.volume_mm3) +
                                 " mm3: the triangles face inward or enclose nothing");
  }
  if (health.crossing.empty()) return;
  const auto [one, other] = health.crossing.front();
  add(Defect::SelfIntersection, std::to_string(health.self_intersections) +
                                    " pairs of triangles that intersect (first: triangles " +
                                    std::to_string(one) + " and " + std::to_string(other) +
                                    place_of(triangles, static_cast<std::uint32_t>(other)) + ")");
}

}  // namespace

Health health(const Triangles& triangles, const HealthOptions& options) {
  check_points(triangles);
  Health health;
  Offenders offenders;
  std::vector<std::uint32_t> shell, first;
  std::optional<MortonTree> tree;
  tbb::parallel_invoke([&] { shell = count_connections(triangles, health, offenders); },
                       [&] {
                         if (options.self_intersections) tree.emplace(triangles);
                       },
                       [&] { first = first_in_use(triangles); });
  count_coincident(triangles, first, health);
  const std::vector<std::uint8_t> degenerate = mark_degenerate(triangles, health, offenders);

  health.closed = health.faces > 0 && health.boundary_edges == 0;
  health.manifold = health.faces > 0 && health.nonmanifold_edges == 0 && health.nonmanifold_vertices == 0;
  health.oriented = health.faces > 0 && health.nonmanifold_edges == 0 && health.misoriented_edges == 0;
  const bool places = health.closed && health.oriented;
  if (!tree && places && health.shells > 1) tree.emplace(triangles);
  PlacedShells placed;
  if (places) {
    placed = place_shells(triangles, first, shell, tree ? &*tree : nullptr, health, offenders);
    health.oriented = health.misplaced_shells == 0 && placed.volume_mm3 > 0.0;
  }
  if (options.self_intersections) test_intersections(triangles, *tree, degenerate, health);
  tell(triangles, health, offenders, placed);
  return health;
}

Health health(const Mesh& mesh, const HealthOptions& options) {
  return health(triangles_of(mesh), options);
}

}  // namespace octotomy::brep
