// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 triangulate the plane with the sides of both sections as constraints, with exact crossings; 2 flood from
// outside to find which sections contain each triangle; 3 lift the triangles that only one section contains,
// and split edges that would lie flat in a section's plane; 4 add vertical walls at sides that are crossed by
// the other section. The lifted triangles are a graph over the plane and the walls are vertical below or
// above its border, so nothing can cross. Only edges of contours lie in a section's plane, so neighbouring
// slabs share nothing else.
#include "brep/contour/slab.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <cassert>
#include <limits>
#include <string>
#include <unordered_map>

#include "brep/mesh/disjoint_sets.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

enum Level : std::uint8_t { at_lower, at_upper, half_way };

struct Mark {
  Level level = half_way;  ///< half_way: the vertex is a crossing of sides
  std::uint32_t point = none;
  std::uint32_t contour = none;  ///< number of its contour, counted over both sections
};
struct Held {
  std::uint8_t by = 0;  ///< sections that contain the face; bit 0: the lower one, bit 1: the upper one
  bool seen = false;
};

using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Mark, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel,
                                                CGAL::Triangulation_face_base_with_info_2<Held, Kernel>>;
using Plane = CGAL::Constrained_triangulation_plus_2<CGAL::Constrained_Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>, CGAL::Exact_intersections_tag>>;
using Vertex = Plane::Vertex_handle;
using Face = Plane::Face_handle;

/// A key for an unordered pair of points.
std::uint64_t key_of(std::uint32_t a, std::uint32_t b) {
  return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

class Overlay {
 public:
  explicit Overlay(const Slab& slab)
      : slab_(slab),
        half_mm_(0.5 * (slab.low_mm + slab.high_mm)),
        joined_(slab.lower.size() + slab.upper.size()) {}

  SlabSurface run() {
    insert(slab_.lower, at_lower, 0);
    insert(slab_.upper, at_upper, static_cast<std::uint32_t>(slab_.lower.size()));
    for (std::size_t s = 0; s < sides_.size(); ++s) follow_side(sides_[s]);
    flood();
    for (const Face face : plane_.finite_face_handles())
      if (face->info().by == 1 || face->info().by == 2) lift(face);
    for (const Side& side : sides_)
      if (side.chain.size() > 2) add_wall(side);
    number_groups();
    return std::move(surface_);
  }

 private:
  struct Side {
    Level level;
    Vertex from, to;
    Plane::Constraint_id constraint;
    std::vector<Vertex> chain;  ///< the side's points, including the crossings on it
  };

  std::string name(std::uint32_t contour) const {
    const bool lower = contour < slab_.lower.size();
    return "contour " + std::to_string(lower ? contour : contour - slab_.lower.size()) + " at " +
           std::to_string(lower ? slab_.low_mm : slab_.high_mm) + " mm";
  }

  void insert(const std::vector<Contour>& section, Level level, std::uint32_t first_contour) {
    Face hint;
    for (std::uint32_t c = 0; c < section.size(); ++c) {
      std::vector<Vertex> ring;
      for (const glm::dvec2& p : section[c].points_mm) {
        const std::size_t before = plane_.number_of_vertices();
        assert(std::isfinite(p.x) && std::isfinite(p.y));
        const Vertex v = plane_.insert(Kernel::Point_2(p.x, p.y), hint);
        if (plane_.number_of_vertices() == before) refuse_same_place(v, level, first_contour + c);
        v->info() = {level, point_count_++, first_contour + c};
        hint = v->face();
        ring.push_back(v);
      }
      for (std::size_t k = 0; k < ring.size(); ++k)
        sides_.push_back({level, ring[k], ring[(k + 1) % ring.size()], {}, {}});
    }
    // Sides are inserted after all points, so that a point on a side is detected.
    if (level == at_upper)
      for (Side& side : sides_) side.constraint = plane_.insert_constraint(side.from, side.to);
  }

  [[noreturn]] void refuse_same_place(Vertex there, Level level, std::uint32_t contour) const {
    assert(there->info().level != half_way);
    if (there->info().level == level)
      throw ContoursMeet(name(contour) + " and " + name(there->info().contour) + " have a point in common");
    throw SectionsCoincide(name(contour) + " and " + name(there->info().contour) + " share a point");
  }

  /// Records the crossings on a side and which sections it bounds.
  void follow_side(Side& side) {
    const std::uint32_t contour = side.from->info().contour;
    for (auto v = plane_.vertices_in_constraint_begin(side.constraint);
         v != plane_.vertices_in_constraint_end(side.constraint); ++v)
      side.chain.push_back(*v);
    assert(side.chain.size() >= 2);
    if (side.chain.front() != side.from) std::reverse(side.chain.begin(), side.chain.end());
    for (std::size_t k = 1; k + 1 < side.chain.size(); ++k) {
      Mark& mark = side.chain[k]->info();
      if (mark.level != half_way) refuse_same_place(side.chain[k], side.level, contour);
      if (mark.point == none) {
        mark.point = static_cast<std::uint32_t>(point_count_ + surface_.inner_mm.size());
        mark.contour = contour;
        const auto& p = side.chain[k]->point();
        surface_.inner_mm.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()), half_mm_);
      } else if (++crossed_[mark.point] > 1) {
        throw SectionsCoincide("three sides cross in one point");
      } else if ((mark.contour < slab_.lower.size()) == (contour < slab_.lower.size())) {
        throw ContoursMeet(name(contour) + " and " + name(mark.contour) + " cross");
      } else {
        joined_.join(mark.contour, contour);
      }
    }
    for (std::size_t k = 0; k + 1 < side.chain.size(); ++k)
      bounds_[key_of(side.chain[k]->info().point, side.chain[k + 1]->info().point)] ^=
          static_cast<std::uint8_t>(side.level == at_lower ? 1 : 2);
  }

  static std::uint32_t point_of(Vertex v) { return v->info().point; }

  void flood() {
    if (plane_.dimension() < 2) return;
    std::vector<Face> reached = {plane_.infinite_face()};
    reached.front()->info().seen = true;
    for (std::size_t next = 0; next < reached.size(); ++next)
      for (int k = 0; k < 3; ++k) {
        const Face face = reached[next], beyond = face->neighbor(k);
        if (beyond->info().seen) continue;
        std::uint8_t crossed = 0;
        if (face->is_constrained(k))
          crossed =
              bounds_.at(key_of(point_of(face->vertex(Plane::cw(k))), point_of(face->vertex(Plane::ccw(k)))));
        beyond->info() = {static_cast<std::uint8_t>(face->info().by ^ crossed), true};
        reached.push_back(beyond);
      }
  }

  std::uint32_t half_way_of(Vertex a, Vertex b) {
    const auto [found, is_new] =
        middles_.try_emplace(key_of(point_of(a), point_of(b)),
                             static_cast<std::uint32_t>(point_count_ + surface_.inner_mm.size()));
    if (is_new) {
      const auto p = CGAL::midpoint(a->point(), b->point());
      surface_.inner_mm.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()), half_mm_);
    }
    return found->second;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool turned, std::uint32_t contour) {
    assert(a != b && b != c && c != a);
    surface_.faces.push_back({a, turned ? c : b, turned ? b : c});
    surface_.group.push_back(contour);
  }

  /// Adds a lifted triangle, facing upward if the lower section contains it and downward if the upper one
  /// does.
  void lift(Face face) {
    assert(face->info().by == 1 || face->info().by == 2);
    const bool turned = face->info().by == 2;
    std::array<std::uint32_t, 3> corner{}, middle{};
    std::uint32_t contour = none;
    bool level = true;
    int split = 0;
    for (int k = 0; k < 3; ++k) {
      const Vertex from = face->vertex(k), to = face->vertex(Plane::ccw(k));
      const auto i = static_cast<std::size_t>(k);
      corner[i] = point_of(from);
      level = level && from->info().level == face->vertex(0)->info().level;
      if (contour != none) joined_.join(contour, from->info().contour);
      contour = from->info().contour;
      const bool flat = from->info().level == to->info().level && from->info().level != half_way &&
                        !face->is_constrained(Plane::cw(k));
      middle[i] = flat ? half_way_of(from, to) : none;
      split += flat;
    }
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      add(a, b, c, turned, contour);
    };
    if (split == 0 && level && face->vertex(0)->info().level != half_way) {
      const auto centre = static_cast<std::uint32_t>(point_count_ + surface_.inner_mm.size());
      const auto p =
          CGAL::centroid(face->vertex(0)->point(), face->vertex(1)->point(), face->vertex(2)->point());
      surface_.inner_mm.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()), half_mm_);
      for (std::size_t k = 0; k < 3; ++k) triangle(corner[k], corner[(k + 1) % 3], centre);
      return;
    }
    if (split == 0) return triangle(corner[0], corner[1], corner[2]);
    if (split == 3) {
      for (std::size_t k = 0; k < 3; ++k) triangle(corner[k], middle[k], middle[(k + 2) % 3]);
      return triangle(middle[0], middle[1], middle[2]);
    }
    // Rotates the numbering until side 0 is split and, if two sides are, side 2 is not.
    std::size_t first = 0;
    while (middle[first] == none || middle[(first + 2) % 3] != none) ++first;
    const std::uint32_t a = corner[first], b = corner[(first + 1) % 3], c = corner[(first + 2) % 3];
    const std::uint32_t ab = middle[first], bc = middle[(first + 1) % 3];
    if (bc == none) {
      triangle(a, ab, c);
      return triangle(ab, b, c);
    }
    triangle(ab, b, bc);
    triangle(a, ab, bc);
    triangle(a, bc, c);
  }

  /// Adds the vertical polygon between a side and the crossings on it.
  void add_wall(const Side& side) {
    const bool upper = side.level == at_upper;
    const std::uint32_t from = point_of(side.from), contour = side.from->info().contour;
    std::uint32_t last = point_of(side.to);
    for (std::size_t k = side.chain.size() - 2; k > 0; --k) {
      add(from, last, point_of(side.chain[k]), upper, contour);
      last = point_of(side.chain[k]);
    }
  }

  void number_groups() {
    std::vector<std::uint32_t> number(slab_.lower.size() + slab_.upper.size(), none);
    const auto lower_count = static_cast<std::uint32_t>(slab_.lower.size());
    for (std::uint32_t c = 0; c < number.size(); ++c) {
      std::uint32_t& group = number[joined_.set_of(c)];
      if (group == none) {
        group = static_cast<std::uint32_t>(surface_.groups.size());
        surface_.groups.emplace_back();
      }
      if (c < lower_count)
        surface_.groups[group].lower.push_back(c);
      else
        surface_.groups[group].upper.push_back(c - lower_count);
    }
    assert(surface_.group.size() == surface_.faces.size());
    for (std::uint32_t& group : surface_.group) group = number[joined_.set_of(group)];
  }

  const Slab& slab_;
  double half_mm_;
  Plane plane_;
  std::uint32_t point_count_ = 0;
  std::vector<Side> sides_;
  std::unordered_map<std::uint64_t, std::uint8_t> bounds_;    ///< sections that a piece of a side bounds
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< middle points of flat edges
  std::unordered_map<std::uint32_t, int> crossed_;
  DisjointSets joined_;
  SlabSurface surface_;
};

}  // namespace

SlabSurface overlay(const Slab& slab) {
  return Overlay(slab).run();
}

}  // namespace octotomy::brep
