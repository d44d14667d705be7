// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 find the triangles that intersect; 2 corefine these near patches; 3 decide for each far part whether it
// is inside the other solid: its border edges show this by being in a result or not; 4 confirm this by a ray
// from each far part; for parts without a border, the ray alone decides; 5 join: far triangles keep their
// points, near ones use the far points at their borders. A border belongs to a triangle that does not meet
// the other surface, so no cut reaches it.
#include "brep/boolean/near_boolean.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "brep/boolean/corefine_batches.h"
#include "brep/boolean/patch.h"
#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/flat_triangles.h"
#include "brep/mesh/intersecting_triangles.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/row_crossing.h"

namespace octotomy::brep {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
/// From this number of probes on, building a tree (n log n) costs less than testing all triangles for each
/// probe.
constexpr std::size_t probes_worth_a_tree = 64;

using PointKey = std::array<double, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;
using EdgePlace = std::pair<PointKey, PointKey>;

PointKey place_of(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

Edge edge_of(std::uint32_t v, std::uint32_t w) {
  return {std::min(v, w), std::max(v, w)};
}

/// The position of an edge, and its points in the order of their coordinates.
std::pair<EdgePlace, Edge> placed(const Triangles& triangles, const Edge& edge) {
  const PointKey p = place_of(triangles.points_mm[edge.first]),
                 q = place_of(triangles.points_mm[edge.second]);
  if (q < p) return {{q, p}, {edge.second, edge.first}};
  return {{p, q}, edge};
}

/// A solid, and the triangles to cut: the solid's own, or others that cover the same surface.
struct Operand {
  const Solid& solid;
  const Linked& linked;

  const Triangles& triangles() const { return linked.triangles; }
};

/// Thrown with the reason why the Boolean cannot be computed from the triangles near the cut alone.
struct Obstacle : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One operand, divided into near triangles and far parts.
struct Side {
  std::vector<std::uint8_t> near;          ///< by triangle: 1 if it is near the cut
  std::vector<std::uint32_t> near_faces;   ///< ascending
  std::vector<std::uint32_t> part;         ///< by point: the part of its far triangles; none if it has no far
                                           ///< triangle
  std::vector<std::uint32_t> first;        ///< by part: one of its points that is off the other surface
  std::vector<std::uint8_t> touching;      ///< by point: 1 if its triangles are far but may touch the other
                                           ///<   surface
  std::vector<double> volumes_mm3;         ///< by part: total volume of the cones from the tip to its
                                           ///< triangles
  std::vector<std::uint32_t> widest;       ///< by part: the triangle that is widest when projected along x
  std::map<Edge, std::uint32_t> border;    ///< by edge between a near and a far triangle: the far triangle's
                                           ///< part
  std::map<EdgePlace, Edge> border_edges;  ///< the same edges by position, with their points in that order
  std::vector<std::uint8_t> inside;        ///< by part: 1 if it is inside the other solid
  std::vector<std::uint8_t> known;         ///< by part: 1 if a border has decided `inside`

  /// The part of a far triangle.
  std::uint32_t part_of(const std::array<std::uint32_t, 3>& face) const { return part[face[0]]; }
};

double cone_mm3(const Triangles& triangles, const std::array<std::uint32_t, 3>& face, const glm::dvec3& tip) {
  const glm::dvec3 a = triangles.points_mm[face[0]] - tip, b = triangles.points_mm[face[1]] - tip,
                   c = triangles.points_mm[face[2]] - tip;
  return glm::dot(a, glm::cross(b, c)) / 6.0;
}

/// Calls visit(side) for each side that leaves the same point as `first`, beginning with `first`. Each
/// belongs to a different triangle. Precondition: the surface is closed, so that the sides form a cycle.
template <typename Visit>
void visit_leaving(const Linked& linked, std::uint32_t first, const Visit& visit) {
  std::uint32_t side = first;
  do {
    assert(linked.from(side) == linked.from(first));
    visit(side);
    side = linked.opposite[side % 3 == 0 ? side + 2 : side - 1];
  } while (side != first);
}

/// Marks the given triangles, which meet the other surface. Where the marked triangles around a point form
/// two fans, marks all triangles around the point, because corefinement would treat the point as two
/// different ones.
void mark_near(const Operand& operand, const std::vector<std::uint32_t>& meeting, Side& side) {
  side.near.assign(operand.triangles().faces.size(), 0);
  side.touching.assign(operand.triangles().points_mm.size(), 0);
  std::vector<std::uint32_t> unseen;  // each side stands for the point at which it begins
  const auto mark = [&](std::uint32_t f) {
    assert(f < side.near.size());
    if (side.near[f]) return;
    side.near[f] = 1;
    side.near_faces.push_back(f);
    unseen.insert(unseen.end(), {3 * f, 3 * f + 1, 3 * f + 2});
  };
  for (const std::uint32_t f : meeting) mark(f);
  while (!unseen.empty()) {
    const std::uint32_t leaving = unseen.back();
    unseen.pop_back();
    int fans = 0;
    visit_leaving(operand.linked, leaving, [&](std::uint32_t s) {
      fans += side.near[s / 3] && !side.near[operand.linked.opposite[s] / 3];
    });
    if (fans < 2) continue;
    visit_leaving(operand.linked, leaving, [&](std::uint32_t s) { mark(s / 3); });
  }
  std::sort(side.near_faces.begin(), side.near_faces.end());
}

/// Joins far triangles that share a point into parts. The other surface cuts none of them, so each part is
/// wholly inside or outside.
void find_parts(const Operand& operand, Side& side) {
  const auto& faces = operand.triangles().faces;
  DisjointSets parts(operand.triangles().points_mm.size());
  side.part.assign(operand.triangles().points_mm.size(), none);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (side.near[f]) continue;
    parts.join(faces[f][0], faces[f][1]);
    parts.join(faces[f][1], faces[f][2]);
    for (const std::uint32_t v : faces[f]) side.part[v] = 0;
  }
  // A part is numbered at its lowest point, which is reached before its other points.
  side.first.clear();
  for (std::uint32_t v = 0; v < side.part.size(); ++v) {
    if (side.part[v] == none) continue;
    if (parts.set_of(v) == v) {
      side.part[v] = static_cast<std::uint32_t>(side.first.size());
      side.first.push_back(none);
    } else {
      assert(parts.set_of(v) < v);
      side.part[v] = side.part[parts.set_of(v)];
    }
    std::uint32_t& first = side.first[side.part[v]];
    if (first == none && !side.touching[v]) first = v;
  }
  if (std::find(side.first.begin(), side.first.end(), none) != side.first.end())
    throw Obstacle("all points of a part of an operand touch the other surface");
  side.inside.assign(side.first.size(), 0);
  side.known.assign(side.first.size(), 0);
}

void find_border(const Operand& operand, Side& side) {
  side.border.clear();
  side.border_edges.clear();
  for (const std::uint32_t f : side.near_faces)
    for (std::uint32_t s = 3 * f; s < 3 * f + 3; ++s) {
      if (side.near[operand.linked.opposite[s] / 3]) continue;
      const std::uint32_t from = operand.linked.from(s), to = operand.linked.to(s);
      assert(side.part[from] != none && side.part[from] == side.part[to]);
      side.border[edge_of(from, to)] = side.part[from];
      const auto [place, edge] = placed(operand.triangles(), {from, to});
      if (!side.border_edges.try_emplace(place, edge).second)
        throw Obstacle("sheets of an operand touch along a border");
    }
}

/// Uses compensated sums, because one part may be nearly all of an operand (Neumaier 1974).
void measure_parts(const Operand& operand, const glm::dvec3& tip, Side& side) {
  side.volumes_mm3.assign(side.first.size(), 0.0);
  std::vector<double> lost(side.first.size(), 0.0), widest_mm2(side.first.size(), -1.0);
  side.widest.assign(side.first.size(), 0);
  for (std::size_t f = 0; f < side.near.size(); ++f) {
    if (side.near[f]) continue;
    const auto& face = operand.triangles().faces[f];
    const std::uint32_t part = side.part_of(face);
    assert(part < side.volumes_mm3.size());
    const double term = cone_mm3(operand.triangles(), face, tip), sum = side.volumes_mm3[part] + term;
    lost[part] += std::abs(side.volumes_mm3[part]) >= std::abs(term) ? (side.volumes_mm3[part] - sum) + term
                                                                     : (term - sum) + side.volumes_mm3[part];
    side.volumes_mm3[part] = sum;
    const double mm2 = shadow_mm2(corners(operand.triangles(), f));
    if (mm2 > widest_mm2[part]) {
      widest_mm2[part] = mm2;
      side.widest[part] = static_cast<std::uint32_t>(f);
    }
  }
  for (std::size_t part = 0; part < lost.size(); ++part) side.volumes_mm3[part] += lost[part];
}

/// Makes near triangles that are connected to the given points far: they touch the other surface, but it does
/// not cut them.
void take_as_far(const Operand& operand, const std::vector<std::uint32_t>& points, Side& side) {
  std::vector<std::uint8_t> is_among(operand.triangles().points_mm.size(), 0);
  for (const std::uint32_t v : points) is_among[v] = 1;
  std::vector<std::uint32_t> flood;
  const auto take = [&](std::uint32_t f) {
    if (!side.near[f]) return;
    side.near[f] = 0;
    flood.push_back(f);
  };
  for (const std::uint32_t f : side.near_faces) {
    const auto& face = operand.triangles().faces[f];
    if (is_among[face[0]] || is_among[face[1]] || is_among[face[2]]) take(f);
  }
  while (!flood.empty()) {
    const std::uint32_t f = flood.back();
    flood.pop_back();
    for (const std::uint32_t v : operand.triangles().faces[f]) side.touching[v] = 1;
    for (std::uint32_t s = 3 * f; s < 3 * f + 3; ++s) take(operand.linked.opposite[s] / 3);
  }
  std::erase_if(side.near_faces, [&](std::uint32_t f) { return !side.near[f]; });
}

/// The points of a near result that lie on a border, with the matching points of the operands.
struct Seam {
  std::vector<std::uint32_t> on_a, on_b;  ///< by point of the result: the operand's point that it matches, or
                                          ///< none
  std::set<Edge> edges_a, edges_b;        ///< border edges at which the result ends
};

Seam seam_of(const Triangles& result, const Side& a, const Side& b) {
  Seam seam;
  seam.on_a.assign(result.points_mm.size(), none);
  seam.on_b.assign(result.points_mm.size(), none);
  std::map<Edge, int> sides;
  for (const auto& face : result.faces)
    for (std::size_t k = 0; k < 3; ++k) ++sides[edge_of(face[k], face[(k + 1) % 3])];
  // Matches points by their edges, because coordinates may coincide: sheets that touch in a point each have a
  // point there, and a new point may have been rounded to the same place.
  const auto know = [](std::vector<std::uint32_t>& on, std::uint32_t v, std::uint32_t point) {
    if (on[v] != none && on[v] != point) throw Obstacle("sheets of an operand touch at a border");
    on[v] = point;
  };
  for (const auto& [edge, count] : sides) {
    if (count != 1) continue;
    const auto [place, ends] = placed(result, edge);
    const auto in_a = a.border_edges.find(place), in_b = b.border_edges.find(place);
    const bool is_a = in_a != a.border_edges.end(), is_b = in_b != b.border_edges.end();
    if (is_a == is_b) throw Obstacle("a result ends where there is no border");
    const Edge& known = is_a ? in_a->second : in_b->second;
    know(is_a ? seam.on_a : seam.on_b, ends.first, known.first);
    know(is_a ? seam.on_a : seam.on_b, ends.second, known.second);
    (is_a ? seam.edges_a : seam.edges_b).insert(edge_of(known.first, known.second));
  }
  return seam;
}

/// Whether a result contains the parts of an operand that lie inside the other one (true) or outside (false).
bool takes_inside(std::size_t result, bool of_a) {
  return result == of_intersection || result == (of_a ? of_b_minus_a : of_a_minus_b);
}

/// Whether a result contains the operand's parts with reversed winding.
bool turns_round(std::size_t result, bool of_a) {
  return result == (of_a ? of_b_minus_a : of_a_minus_b);
}

/// Decides from the borders of a result whether each part is inside. If an earlier result has decided that,
/// checks that both agree.
void place_parts(const std::set<Edge>& edges, bool inside_where_there, Side& side) {
  for (const auto& [edge, part] : side.border) {
    assert(part < side.known.size());
    const bool inside = edges.contains(edge) == inside_where_there;
    if (side.known[part] && (side.inside[part] != 0) != inside)
      throw Obstacle("the borders of a part disagree whether it is inside");
    side.inside[part] = inside;
    side.known[part] = 1;
  }
}

/// Casts a ray from each part. The ray decides whether a part without a border is inside, and checks the
/// other parts.
void confirm_parts(const Operand& operand, const Operand& other, Side& side) {
  std::vector<glm::dvec3> probes;
  for (const std::uint32_t v : side.first) probes.push_back(operand.triangles().points_mm[v]);
  std::vector<std::uint8_t> inside;
  if (probes.size() >= probes_worth_a_tree)
    inside = other.solid.tree().inside(probes);
  else
    for (const glm::dvec3& probe : probes) inside.push_back(is_inside(probe, other.triangles()));
  for (std::size_t part = 0; part < inside.size(); ++part) {
    if (side.known[part] && inside[part] != side.inside[part])
      throw Obstacle("a ray and the borders of a part disagree whether it is inside");
    side.inside[part] = inside[part];
  }
  assert(inside.size() == side.inside.size());
}

/// Appends the far triangles of one operand that belong to a result. The near result then uses their points
/// on the borders.
class Sewing {
 public:
  void add_far(const Operand& operand, const Side& side, std::size_t result, bool of_a) {
    const bool inside = takes_inside(result, of_a), turned = turns_round(result, of_a);
    std::vector<std::uint32_t>& numbers = of_a ? number_a_ : number_b_;
    numbers.assign(operand.triangles().points_mm.size(), none);
    for (std::uint32_t v = 0; v < numbers.size(); ++v) {
      if (side.part[v] == none || (side.inside[side.part[v]] != 0) != inside) continue;
      numbers[v] = static_cast<std::uint32_t>(sewn_.points_mm.size());
      sewn_.points_mm.push_back(operand.triangles().points_mm[v]);
    }
    for (std::uint32_t f = 0; f < side.near.size(); ++f) {
      const auto& face = operand.triangles().faces[f];
      if (side.near[f] || numbers[face[0]] == none) continue;
      assert(numbers[face[1]] != none && numbers[face[2]] != none);
      const std::size_t second = turned ? 2 : 1;
      sewn_.faces.push_back({numbers[face[0]], numbers[face[second]], numbers[face[3 - second]]});
    }
  }

  void add_near(const Triangles& near, const Seam& seam) {
    std::vector<std::uint32_t> numbers(near.points_mm.size(), none);
    for (std::size_t v = 0; v < numbers.size(); ++v) {
      if (seam.on_a[v] != none) numbers[v] = number_a_[seam.on_a[v]];
      if (seam.on_b[v] != none) numbers[v] = number_b_[seam.on_b[v]];
      if (numbers[v] != none) continue;
      numbers[v] = static_cast<std::uint32_t>(sewn_.points_mm.size());
      sewn_.points_mm.push_back(near.points_mm[v]);
    }
    for (std::array<std::uint32_t, 3> face : near.faces) {
      for (std::uint32_t& v : face) v = numbers[v];
      assert(std::max({face[0], face[1], face[2]}) < sewn_.points_mm.size());
      sewn_.faces.push_back(face);
    }
  }

  Triangles take() { return std::move(sewn_); }

 private:
  std::vector<std::uint32_t> number_a_, number_b_;
  Triangles sewn_;
};

double volume_of(const Triangles& near, const glm::dvec3& tip, std::size_t result,
                 const std::array<Side, 2>& sides) {
  double volume = 0.0;
  for (const auto& face : near.faces) volume += cone_mm3(near, face, tip);
  for (std::size_t s = 0; s < 2; ++s)
    for (std::size_t part = 0; part < sides[s].first.size(); ++part)
      if ((sides[s].inside[part] != 0) == takes_inside(result, s == 0))
        volume += turns_round(result, s == 0) ? -sides[s].volumes_mm3[part] : sides[s].volumes_mm3[part];
  return volume;
}

/// Divides both operands into near triangles and far parts.
std::array<Side, 2> sides_of(const Operand& a, const Operand& b) {
  std::array<Side, 2> sides;
  const IntersectingTriangles meeting = intersecting_triangles(a.triangles(), b.triangles());
  mark_near(a, meeting.of_a, sides[0]);
  mark_near(b, meeting.of_b, sides[1]);
  const std::size_t near = sides[0].near_faces.size() + sides[1].near_faces.size();
  if (2 * near > a.triangles().faces.size() + b.triangles().faces.size())
    throw Obstacle("more than half of the triangles are near the cut");
  return sides;
}

/// Corefines the near triangles. Those that only touch the other surface become far triangles.
Corefined corefine_near(const std::array<Operand, 2>& operands, std::array<Side, 2>& sides,
                        const Wanted& wanted, const std::stop_token& stop) {
  Corefined corefined;
  for (const bool again : {false, true}) {
    for (std::size_t s = 0; s < 2; ++s) {
      find_parts(operands[s], sides[s]);
      find_border(operands[s], sides[s]);
    }
    if (sides[0].near_faces.empty() && sides[1].near_faces.empty()) {
      if (again) throw Obstacle("the surfaces touch without cutting");
      corefined.results.fill(Triangles());
      return corefined;
    }
    const Patch a = patch_of(operands[0].triangles(), sides[0].near_faces),
                b = patch_of(operands[1].triangles(), sides[1].near_faces);
    corefined =
        corefine_in_batches(a.mesh, b.mesh, {true, true, wanted[of_a_minus_b], wanted[of_b_minus_a]}, stop);
    if (!corefined.failure.empty()) throw Obstacle(corefined.failure);
    if (corefined.has_open_film || corefined.films != decltype(corefined.films){})
      throw Obstacle("faces coincide except for rounding, near the cut and perhaps beyond");
    if (corefined.uncut[0].empty() && corefined.uncut[1].empty()) return corefined;
    if (again || corefined.flat > 0) throw Obstacle("the surfaces touch without cutting");
    for (std::size_t s = 0; s < 2; ++s) {
      const Patch& patch = s == 0 ? a : b;
      for (std::uint32_t& v : corefined.uncut[s]) v = patch.points.at(v);
      take_as_far(operands[s], corefined.uncut[s], sides[s]);
    }
  }
  return corefined;
}

void sew(const Operand& a, const Operand& b, const Wanted& wanted, const std::stop_token& stop,
         NearBoolean& answer) {
  std::array<Side, 2> sides = sides_of(a, b);
  const Corefined corefined = corefine_near({a, b}, sides, wanted, stop);
  answer.meets_itself = corefined.meets_itself;
  answer.flat = corefined.flat;

  std::array<std::optional<Seam>, 4> seams;
  for (std::size_t r = 0; r < seams.size(); ++r) {
    if (!corefined.results[r]) continue;
    seams[r] = seam_of(*corefined.results[r], sides[0], sides[1]);
    place_parts(seams[r]->edges_a, takes_inside(r, true), sides[0]);
    place_parts(seams[r]->edges_b, takes_inside(r, false), sides[1]);
  }
  confirm_parts(a, b, sides[0]);
  confirm_parts(b, a, sides[1]);

  const glm::dvec3 tip = a.triangles().points_mm.empty() ? glm::dvec3(0.0) : a.triangles().points_mm.front();
  measure_parts(a, tip, sides[0]);
  measure_parts(b, tip, sides[1]);
  for (std::size_t s = 0; s < 2; ++s)
    for (const std::uint32_t f : sides[s].widest)
      answer.widest.push_back(corners(s == 0 ? a.triangles() : b.triangles(), f));
  for (std::size_t r = 0; r < seams.size(); ++r) {
    if (!seams[r] && wanted[r]) throw Obstacle("a result would not be manifold");
    if (!seams[r]) continue;
    if (!wanted[r]) {
      answer.volumes_mm3[r] = volume_of(*corefined.results[r], tip, r, sides);
      continue;
    }
    Sewing sewing;
    sewing.add_far(a, sides[0], r, true);
    sewing.add_far(b, sides[1], r, false);
    sewing.add_near(*corefined.results[r], *seams[r]);
    answer.results[r] = sewing.take();
    answer.volumes_mm3[r] = size_of(*answer.results[r]).volume_mm3;
    const std::vector<Corners> of_near = widest_triangles(*corefined.results[r]);
    answer.widest.insert(answer.widest.end(), of_near.begin(), of_near.end());
  }
}

/// If the operands have triangles without area, repeats the computation with other triangles of the same
/// surfaces. A triangle without area that crosses the border would make corefinement fail.
void sew_flattened(const Solid& a, const Solid& b, const Wanted& wanted, const std::stop_token& stop,
                   NearBoolean& answer) {
  std::size_t taken = 0;
  const auto flattened = [&](const Solid& solid) -> std::optional<Linked> {
    if (!has_flat_triangles(solid.triangles())) return {};
    Mesh mesh = solid.mesh();
    taken += take_out_flat_triangles(mesh).taken();
    return linked_of(mesh);
  };
  const std::optional<Linked> of_a = flattened(a), of_b = flattened(b);
  if (taken == 0) return;
  answer = {};
  sew({a, of_a ? *of_a : a.linked()}, {b, of_b ? *of_b : b.linked()}, wanted, stop, answer);
  answer.flat += taken;
}

}  // namespace

NearBoolean near_boolean(const Solid& a, const Solid& b, const Wanted& wanted, const std::stop_token& stop) {
  NearBoolean answer;
  const auto attempt = [&](const auto& sew_them) {
    try {
      sew_them();
    } catch (const Obstacle& obstacle) {
      answer = {};
      answer.obstacle = obstacle.what();
    }
  };
  attempt([&] { sew({a, a.linked()}, {b, b.linked()}, wanted, stop, answer); });
  if (!answer.obstacle.empty() || answer.meets_itself)
    attempt([&] { sew_flattened(a, b, wanted, stop, answer); });
  return answer;
}

}  // namespace octotomy::brep
