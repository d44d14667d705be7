// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 sort the sides of all triangles by edge; 2 count edges, fans and shells from runs of equal edges; 3 count
// degenerate and duplicate triangles; 4 place each shell among the others by a ray; 5 test for intersections
// the pairs whose boxes overlap (Zomorodian, Edelsbrunner 2002, as CGAL's box_intersection_d), each pair by
// exact predicates. Works on triangles rather than halfedges so that what is not manifold can be reported.
#include "brep/mesh/health.h"

// CGAL's boxes in parallel; no other part of it is.
#ifndef CGAL_LINKED_WITH_TBB
#define CGAL_LINKED_WITH_TBB
#endif
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/distance.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
constexpr std::size_t crossing_limit = 100;

Kernel::Point_3 exact(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

void check_points(const Triangles& triangles) {
  for (std::size_t f = 0; f < triangles.faces.size(); ++f)
    for (const std::uint32_t v : triangles.faces[f]) {
      if (v >= triangles.points_mm.size())
        throw Error(ErrorCode::Input, "triangle " + std::to_string(f) + " refers to point " +
                                          std::to_string(v) + " of " +
                                          std::to_string(triangles.points_mm.size()));
      const glm::dvec3& p = triangles.points_mm[v];
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        throw Error(ErrorCode::Input, "triangle " + std::to_string(f) + " has a point that is not finite");
    }
}

/// Side `corner % 3` of triangle `corner / 3`, from that corner to the next.
struct Side {
  std::uint32_t low, high, corner;
  bool upward;  ///< runs from the lower point number to the higher
};

std::vector<Side> sorted_sides(const Triangles& triangles) {
  std::vector<Side> sides(3 * triangles.faces.size());
  for (std::uint32_t c = 0; c < sides.size(); ++c) {
    const std::uint32_t from = triangles.faces[c / 3][c % 3], to = triangles.faces[c / 3][(c + 1) % 3];
    sides[c] = {std::min(from, to), std::max(from, to), c, from < to};
  }
  tbb::parallel_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corner) < std::tie(b.low, b.high, b.corner);
  });
  return sides;
}

std::uint32_t next_corner(std::uint32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/// The first triangle that each of the findings is about.
struct Offenders {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t boundary = none, nonmanifold_edge = none, nonmanifold_vertex = none, misoriented = none,
                degenerate = none, duplicate = none, misplaced = none;

  static void note(std::uint32_t& first, std::uint32_t triangle) { first = std::min(first, triangle); }
};

/// Counts what edges and vertices tell; returns the shell of each triangle, named by its first triangle.
std::vector<std::uint32_t> count_connections(const Triangles& triangles, Health& health,
                                             Offenders& offenders) {
  const std::vector<Side> sides = sorted_sides(triangles);
  DisjointSets shells(triangles.faces.size()), fans(sides.size());
  std::size_t edges = 0;
  for (std::size_t i = 0, j; i < sides.size(); i = j) {
    for (j = i + 1; j < sides.size() && sides[j].low == sides[i].low && sides[j].high == sides[i].high; ++j) {
      const Side &a = sides[i], &b = sides[j];
      shells.join(a.corner / 3, b.corner / 3);
      const bool same_way = a.upward == b.upward;
      fans.join(a.corner, same_way ? b.corner : next_corner(b.corner));
      fans.join(next_corner(a.corner), same_way ? next_corner(b.corner) : b.corner);
    }
    ++edges;
    const std::uint32_t first = sides[i].corner / 3;
    assert(first < triangles.faces.size());
    if (j - i == 1) {
      ++health.boundary_edges;
      Offenders::note(offenders.boundary, first);
    } else if (j - i > 2) {
      ++health.nonmanifold_edges;
      Offenders::note(offenders.nonmanifold_edge, first);
    } else if (sides[i].upward == sides[i + 1].upward) {
      ++health.misoriented_edges;
      Offenders::note(offenders.misoriented, first);
    }
  }

  std::vector<std::uint32_t> fan_count(triangles.points_mm.size(), 0);
  for (std::uint32_t c = 0; c < sides.size(); ++c)
    if (fans.set_of(c) == c) ++fan_count[triangles.faces[c / 3][c % 3]];
  health.vertices = triangles.points_mm.size();
  for (const std::uint32_t count : fan_count) {
    if (count == 0) ++health.unused_vertices;
    if (count > 1) ++health.nonmanifold_vertices;
  }
  for (std::uint32_t c = 0; health.nonmanifold_vertices > 0 && c < sides.size(); ++c)
    if (fan_count[triangles.faces[c / 3][c % 3]] > 1) Offenders::note(offenders.nonmanifold_vertex, c / 3);
  DisjointSets bodies(triangles.points_mm.size());
  for (const auto& face : triangles.faces) {
    bodies.join(face[0], face[1]);
    bodies.join(face[1], face[2]);
  }
  for (std::uint32_t v = 0; v < fan_count.size(); ++v)
    if (fan_count[v] > 0 && bodies.set_of(v) == v) ++health.components;

  std::vector<std::uint32_t> shell(triangles.faces.size());
  for (std::uint32_t f = 0; f < shell.size(); ++f) {
    shell[f] = shells.set_of(f);
    if (shell[f] == f) ++health.shells;
  }
  health.faces = triangles.faces.size();
  health.euler = static_cast<long>(health.vertices - health.unused_vertices) - static_cast<long>(edges) +
                 static_cast<long>(health.faces);
  return shell;
}

/// Counts points that stand on others, and the boundary edges that end when those become one.
void count_coincident(const Triangles& triangles, Health& health) {
  std::vector<glm::dvec3> points_mm(triangles.points_mm.size(), glm::dvec3(0.0));
  std::vector<std::uint8_t> used(points_mm.size(), 0);
  std::vector<std::uint32_t> number(points_mm.size()), in_use;
  for (const auto& face : triangles.faces)
    for (const std::uint32_t v : face) used[v] = 1;
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    number[v] = static_cast<std::uint32_t>(in_use.size());
    points_mm[in_use.size()] = triangles.points_mm[v];
    in_use.push_back(v);
  }
  points_mm.resize(in_use.size());
  const std::vector<std::uint32_t> first = first_equal_points(points_mm);
  for (std::uint32_t i = 0; i < first.size(); ++i) health.coincident_points += first[i] != i;
  if (health.coincident_points == 0 || health.boundary_edges == 0) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * triangles.faces.size());
  for (const auto& face : triangles.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = first[number[face[k]]], to = first[number[face[(k + 1) % 3]]];
      if (from != to) edges.emplace_back(std::min(from, to), std::max(from, to));
    }
  tbb::parallel_sort(edges.begin(), edges.end());
  std::size_t open = 0;
  for (std::size_t i = 0, j; i < edges.size(); i = j) {
    for (j = i + 1; j < edges.size() && edges[j] == edges[i];) ++j;
    open += j - i == 1;
  }
  health.unwelded_edges = health.boundary_edges - std::min(open, health.boundary_edges);
}

/// Marks triangles without area, exactly.
std::vector<std::uint8_t> mark_degenerate(const Triangles& triangles, Health& health, Offenders& offenders) {
  std::vector<std::uint8_t> degenerate(triangles.faces.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, degenerate.size(), 4096), [&](const auto& range) {
    for (std::size_t f = range.begin(); f != range.end(); ++f) {
      const auto& v = triangles.faces[f];
      degenerate[f] = CGAL::collinear(exact(triangles.points_mm[v[0]]), exact(triangles.points_mm[v[1]]),
                                      exact(triangles.points_mm[v[2]]));
    }
  });
  for (std::size_t f = 0; f < degenerate.size(); ++f) {
    if (degenerate[f] == 0) continue;
    ++health.degenerate_faces;
    Offenders::note(offenders.degenerate, static_cast<std::uint32_t>(f));
  }
  return degenerate;
}

void count_duplicates(const Triangles& triangles, Health& health, Offenders& offenders) {
  std::vector<std::pair<std::array<std::uint32_t, 3>, std::uint32_t>> faces;
  faces.reserve(triangles.faces.size());
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f) {
    faces.emplace_back(triangles.faces[f], f);
    std::sort(faces.back().first.begin(), faces.back().first.end());
  }
  tbb::parallel_sort(faces.begin(), faces.end());
  std::size_t earlier = 0;
  for (std::size_t i = 1; i < faces.size(); ++i) {
    earlier = faces[i].first == faces[i - 1].first ? earlier + 1 : 0;
    health.duplicate_faces += earlier;
    if (earlier == 1) Offenders::note(offenders.duplicate, faces[i - 1].second);
  }
}

/// Marks points that stand where a point of another shell does.
std::vector<std::uint8_t> mark_touching(const Triangles& triangles, const std::vector<std::uint32_t>& shell) {
  struct Corner {
    glm::dvec3 p_mm;
    std::uint32_t shell, point;
  };
  std::vector<Corner> corners;
  corners.reserve(3 * shell.size());
  for (std::uint32_t f = 0; f < shell.size(); ++f)
    for (const std::uint32_t v : triangles.faces[f]) corners.push_back({triangles.points_mm[v], shell[f], v});
  tbb::parallel_sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tie(a.p_mm.x, a.p_mm.y, a.p_mm.z) < std::tie(b.p_mm.x, b.p_mm.y, b.p_mm.z);
  });
  assert(corners.size() == 3 * triangles.faces.size());
  std::vector<std::uint8_t> touching(triangles.points_mm.size(), 0);
  for (std::size_t i = 0, j; i < corners.size(); i = j) {
    bool several = false;
    for (j = i + 1; j < corners.size() && corners[j].p_mm == corners[i].p_mm; ++j)
      several = several || corners[j].shell != corners[i].shell;
    if (!several) continue;
    for (std::size_t k = i; k < j; ++k) touching[corners[k].point] = 1;
  }
  return touching;
}

/// Counts shells on the wrong side of the others: the shells around one must add up to no winding where it is
/// turned outward, to one where it is turned inward. Returns the total volume. Needs a closed, manifold,
/// consistently wound mesh.
double place_shells(const Triangles& triangles, const std::vector<std::uint32_t>& shell, Health& health,
                    Offenders& offenders) {
  assert(health.closed && health.nonmanifold_edges == 0 && health.misoriented_edges == 0);
  struct Probe {
    double volume_mm3 = 0.0;
    /// The shell's point of largest x, one that no other shell shares where there is any.
    glm::dvec3 p_mm{-std::numeric_limits<double>::infinity()};
    bool touches = true;
  };
  const std::vector<std::uint8_t> touching = health.shells > 1
                                                 ? mark_touching(triangles, shell)
                                                 : std::vector<std::uint8_t>(triangles.points_mm.size(), 0);
  std::map<std::uint32_t, Probe> probes;
  double volume_mm3 = 0.0;
  for (std::uint32_t f = 0; f < shell.size(); ++f) {
    Probe& probe = probes[shell[f]];
    const auto point = [&](int k) {
      return triangles.points_mm[triangles.faces[f][static_cast<std::size_t>(k)]];
    };
    for (const std::uint32_t v : triangles.faces[f]) {
      const glm::dvec3& p = triangles.points_mm[v];
      const bool touches = touching[v] != 0;
      if (touches != probe.touches ? probe.touches : p.x > probe.p_mm.x) {
        probe.p_mm = p;
        probe.touches = touches;
      }
    }
    // About the shell's first point, which keeps digits far from the origin.
    const glm::dvec3 origin = triangles.points_mm[triangles.faces[shell[f]][0]];
    probe.volume_mm3 += glm::dot(point(0) - origin, glm::cross(point(1) - origin, point(2) - origin)) / 6.0;
  }
  const SurfaceTree tree(triangles);
  for (const auto& [name, probe] : probes) {
    volume_mm3 += probe.volume_mm3;
    int winding = 0;
    for (const Crossing& crossing : tree.crossings(probe.p_mm))
      if (shell[crossing.face] != name) winding += crossing.leaving ? 1 : -1;
    if (winding == (probe.volume_mm3 > 0.0 ? 0 : 1)) continue;
    ++health.misplaced_shells;
    Offenders::note(offenders.misplaced, name);
  }
  return volume_mm3;
}

using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::uint32_t,
                                                      CGAL::Box_intersection_d::ID_FROM_BOX_ADDRESS>;

/// Whether two triangles meet elsewhere than in the corners or the side they share.
class MeetsElsewhere {
 public:
  explicit MeetsElsewhere(const Triangles& triangles) : triangles_(triangles) {}

  bool operator()(std::uint32_t f, std::uint32_t g) const {
    const auto &a = triangles_.faces[f], &b = triangles_.faces[g];
    // Corners of each that the other has too, and one that it has not.
    std::size_t shared = 0, own_a = 0, own_b = 0, shared_a = 0, shared_b = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto at = std::find(b.begin(), b.end(), a[i]);
      if (at == b.end()) {
        own_a = i;
        continue;
      }
      ++shared;
      shared_a = i;
      shared_b = static_cast<std::size_t>(at - b.begin());
    }
    if (shared == 3) return true;
    if (shared == 0) return CGAL::do_intersect(triangle(a), triangle(b));
    if (shared == 1)
      return CGAL::do_intersect(triangle(a), opposite(b, shared_b)) ||
             CGAL::do_intersect(triangle(b), opposite(a, shared_a));
    assert(shared == 2);
    for (std::size_t i = 0; i < 3; ++i)
      if (std::find(a.begin(), a.end(), b[i]) == a.end()) own_b = i;
    // Folded flat onto each other: coplanar, with both free corners on one side of the shared edge.
    const Kernel::Point_3 p = point(a[(own_a + 1) % 3]), q = point(a[(own_a + 2) % 3]);
    const Kernel::Point_3 r = point(a[own_a]), s = point(b[own_b]);
    return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
  }

 private:
  using Face = std::array<std::uint32_t, 3>;
  Kernel::Point_3 point(std::uint32_t v) const { return exact(triangles_.points_mm[v]); }
  Kernel::Triangle_3 triangle(const Face& f) const { return {point(f[0]), point(f[1]), point(f[2])}; }
  Kernel::Segment_3 opposite(const Face& f, std::size_t corner) const {
    return {point(f[(corner + 1) % 3]), point(f[(corner + 2) % 3])};
  }

  const Triangles& triangles_;
};

void test_intersections(const Triangles& triangles, const std::vector<std::uint8_t>& degenerate,
                        Health& health) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.faces.size());
  for (std::uint32_t f = 0; f < triangles.faces.size(); ++f) {
    if (degenerate[f]) continue;
    CGAL::Bbox_3 box;
    for (const std::uint32_t v : triangles.faces[f]) box += exact(triangles.points_mm[v]).bbox();
    boxes.emplace_back(box, f);
  }
  std::vector<const Box*> order(boxes.size());
  std::transform(boxes.begin(), boxes.end(), order.begin(), [](const Box& box) { return &box; });

  using Pair = std::pair<std::uint32_t, std::uint32_t>;
  tbb::enumerable_thread_specific<std::vector<Pair>> found;
  const MeetsElsewhere meets_elsewhere(triangles);
  // CGAL's cutoff below which boxes are scanned instead of divided; any value gives the same pairs.
  constexpr std::ptrdiff_t cutoff = 2000;
  CGAL::box_self_intersection_d<CGAL::Parallel_tag>(
      order.begin(), order.end(),
      [&](const Box* a, const Box* b) {
        const Pair pair(std::min(a->info(), b->info()), std::max(a->info(), b->info()));
        if (meets_elsewhere(pair.first, pair.second)) found.local().push_back(pair);
      },
      cutoff);
  std::vector<Pair> meeting;
  for (const std::vector<Pair>& part : found) meeting.insert(meeting.end(), part.begin(), part.end());

  std::sort(meeting.begin(), meeting.end());
  health.intersections_tested = true;
  health.self_intersections = meeting.size();
  for (std::size_t i = 0; i < std::min(meeting.size(), crossing_limit); ++i)
    health.crossing.emplace_back(static_cast<int>(meeting[i].first), static_cast<int>(meeting[i].second));
}

/// " at (12.5, -80.25, 3) mm", where a triangle's middle is.
std::string place_of(const Triangles& triangles, std::uint32_t triangle) {
  assert(triangle < triangles.faces.size());
  const auto& [a, b, c] = triangles.faces[triangle];
  const glm::dvec3 middle = (triangles.points_mm[a] + triangles.points_mm[b] + triangles.points_mm[c]) / 3.0;
  std::array<char, 96> place{};
  std::snprintf(place.data(), place.size(), " at (%.6g, %.6g, %.6g) mm", middle.x, middle.y, middle.z);
  return place.data();
}

void tell(const Triangles& triangles, Health& health, const Offenders& offenders, double volume_mm3) {
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
                          std::to_string(health.boundary_edges) + " open edges close when welded, as " +
                          std::to_string(health.coincident_points) + " points stand where others do");
  say(Defect::NonmanifoldEdge, health.nonmanifold_edges, "edges with more than two triangles",
      offenders.nonmanifold_edge);
  say(Defect::NonmanifoldVertex, health.nonmanifold_vertices,
      "vertices where more than one fan of triangles meets", offenders.nonmanifold_vertex);
  say(Defect::Misoriented, health.misoriented_edges, "edges whose triangles wind against each other",
      offenders.misoriented);
  say(Defect::Degenerate, health.degenerate_faces, "triangles without area", offenders.degenerate);
  say(Defect::Duplicate, health.duplicate_faces, "pairs of triangles with the same points",
      offenders.duplicate);
  say(Defect::MisplacedShell, health.misplaced_shells,
      "shells that face the wrong way for the shells around them", offenders.misplaced);
  if (health.closed && health.nonmanifold_edges == 0 && health.misoriented_edges == 0 && !(volume_mm3 > 0.0))
    add(Defect::InsideOut,
        "the volume is " + std::to_string(volume_mm3) + " mm3: the triangles face inward or enclose nothing");
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
  const std::vector<std::uint32_t> shell = count_connections(triangles, health, offenders);
  count_coincident(triangles, health);
  const std::vector<std::uint8_t> degenerate = mark_degenerate(triangles, health, offenders);
  count_duplicates(triangles, health, offenders);

  health.closed = health.faces > 0 && health.boundary_edges == 0;
  health.manifold = health.faces > 0 && health.nonmanifold_edges == 0 && health.nonmanifold_vertices == 0;
  health.oriented = health.faces > 0 && health.nonmanifold_edges == 0 && health.misoriented_edges == 0;
  double volume_mm3 = 0.0;
  if (health.closed && health.oriented) {
    volume_mm3 = place_shells(triangles, shell, health, offenders);
    health.oriented = health.misplaced_shells == 0 && volume_mm3 > 0.0;
  }
  if (options.self_intersections) test_intersections(triangles, degenerate, health);
  tell(triangles, health, offenders, volume_mm3);
  return health;
}

Health health(const Mesh& mesh, const HealthOptions& options) {
  return health(triangles_of(mesh), options);
}

}  // namespace octotomy::brep
