// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Turn the surface so that the direction is the depth, and keep the triangles that face it and may be seen.
// 2 Draw the edges of those triangles into a constrained triangulation of the view: none crosses its faces.
// 3 Each face of the view has the triangle that the line of sight through its middle meets first.
// 4 At each point of the view, the faces around it lie at one depth or at several. Each depth is one point of
//   the shadow: the object's own point if the object has a point there.
// 5 Each covered face makes one triangle at its depth and one in the end plane; each edge between faces of
//   different depths makes a wall.
//
// Step 5 closes the surface for any triangle that step 3 finds: each wall shares its upper and lower edges
// with the two faces beside it, and walls meet along all the depths of a point. Rounding can therefore move
// the surface but not open it.
//
// Departure from the exact lower envelope (Halperin and others, CGAL's Envelope_3): points at which edges
// cross in the view are rounded to doubles, which makes the computation about a hundred times as fast.
#include "brep/shape/shadow.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

#include "brep/mesh/split_fans.h"
#include "brep/shape/front_faces.h"

namespace octotomy::brep {
namespace {

using ViewKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
/// A vertex's info is the number of its point, a face's info the triangle that is seen first.
using ViewVertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, ViewKernel>;
using ViewFaceBase = CGAL::Constrained_triangulation_face_base_2<
    ViewKernel, CGAL::Triangulation_face_base_with_info_2<std::uint32_t, ViewKernel>>;
using ViewPlane = CGAL::Constrained_Delaunay_triangulation_2<
    ViewKernel, CGAL::Triangulation_data_structure_2<ViewVertexBase, ViewFaceBase>,
    CGAL::Exact_predicates_tag>;
using ViewVertex = ViewPlane::Vertex_handle;
using ViewFace = ViewPlane::Face_handle;

glm::dvec2 place_in_view(ViewVertex vertex) {
  return {vertex->point().x(), vertex->point().y()};
}

/// Places in the view are rounded to this share of the extent, far above the rounding of coordinates and far
/// below the size of any part. Triangles that would lie along the direction without rounding then do so
/// exactly, instead of facing it as slivers. Visible points keep their coordinates.
constexpr int place_bits = 36;

/// Depths that differ by less count as equal: coordinates carry 1e-16 of the extent, and a plane that rises
/// 10^5 times its width multiplies this error by 10^5.
constexpr double same_depth_share = 1e-11;

/// The object's points by their places in the view.
class PointsByPlace {
 public:
  explicit PointsByPlace(const std::vector<glm::dvec3>& points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t i, std::uint32_t j) {
      const glm::dvec3 &p = points[i], &q = points[j];
      return std::make_tuple(p.x, p.y, p.z, i) < std::make_tuple(q.x, q.y, q.z, j);
    });
  }

  /// Calls `visit` with every point at exactly this place of the view.
  template <typename Visit>
  void at(const glm::dvec2& place, const Visit& visit) const {
    const auto before = [&](std::uint32_t i, const glm::dvec2& p) {
      return std::make_pair(points_[i].x, points_[i].y) < std::make_pair(p.x, p.y);
    };
    for (auto i = std::lower_bound(order_.begin(), order_.end(), place, before);
         i != order_.end() && glm::dvec2(points_[*i]) == place; ++i)
      visit(*i);
  }

 private:
  const std::vector<glm::dvec3>& points_;
  std::vector<std::uint32_t> order_;
};

/// A depth at a point of the view. Depths in from..to count as this depth.
struct Level {
  double from = 0.0, to = 0.0;
  std::uint32_t point = 0;  ///< number of the shadow's point
};

class ShadowSurface {
 public:
  ShadowSurface(const Solid& solid, const ShadowOptions& options)
      : solid_(solid),
        progress_(options.progress),
        axes_(options.direction),
        points_(turned(solid, axes_)),
        by_place_(points_),
        faces_(solid.linked(), points_) {
    const glm::dvec3 extent = solid.size().high_mm - solid.size().low_mm;
    same_depth_mm_ = same_depth_share * std::max({extent.x, extent.y, extent.z});
    double far = -std::numeric_limits<double>::infinity();
    for (const glm::dvec3& p : points_) far = std::max(far, p.z);
    end_ = std::max(far, options.end_mm);
  }

  Shadow made() {
    progress_.at(0.2);
    draw_edges();
    progress_.at(0.5);
    find_first();
    progress_.at(0.7);
    find_levels();
    for (ViewFace face : view_.finite_face_handles()) add_caps(face);
    // CGAL chooses an edge's face by addresses, which differ from run to run.
    for (ViewFace face : view_.all_face_handles())
      for (int k = 0; k < 3; ++k) {
        const ViewVertex a = face->vertex(ViewPlane::ccw(k)), b = face->vertex(ViewPlane::cw(k));
        if (!view_.is_infinite(a) && !view_.is_infinite(b) && a->info() < b->info()) add_wall(face, k);
      }
    progress_.at(0.9);
    return {trusted_solid(split_fans(surface_).surface, Proof::Rounded), faces_.seen().size()};
  }

 private:
  static std::vector<glm::dvec3> turned(const Solid& solid, const ViewAxes& axes) {
    const glm::dvec3 extent = solid.size().high_mm - solid.size().low_mm;
    const double grid =
        std::exp2(std::ceil(std::log2(std::max({extent.x, extent.y, extent.z}))) - place_bits);
    std::vector<glm::dvec3> points = solid.triangles().points_mm;
    for (glm::dvec3& p : points) {
      p = axes.seen(p);
      p = {std::round(p.x / grid) * grid, std::round(p.y / grid) * grid, p.z};
    }
    return points;
  }

  void draw_edges();
  void find_first();
  void find_levels();
  double depth_at(ViewFace face, ViewVertex vertex) const;
  std::uint32_t level_number(ViewFace face, ViewVertex vertex) const;
  void add_caps(ViewFace face);
  void add_wall(ViewFace face, int opposite);

  bool is_covered(ViewFace face) const {
    return !view_.is_infinite(face) && face->info() != FrontFaces::none;
  }
  const std::vector<Level>& levels(ViewVertex vertex) const { return levels_[vertex->info()]; }

  const Solid& solid_;
  const Progress& progress_;
  ViewAxes axes_;
  std::vector<glm::dvec3> points_;  ///< points of the object, in the view
  PointsByPlace by_place_;
  FrontFaces faces_;
  double same_depth_mm_ = 0.0, end_ = 0.0;
  ViewPlane view_;
  std::vector<std::vector<Level>> levels_;  ///< for each point of the view, its levels, ascending
  Triangles surface_;
};

void ShadowSurface::draw_edges() {
  const auto& triangles = solid_.triangles().faces;
  // The points of visible triangles, each place once.
  std::vector<std::uint32_t> used;
  for (const std::uint32_t i : faces_.seen())
    used.insert(used.end(), triangles[i].begin(), triangles[i].end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<ViewKernel::Point_2> places;
  for (const std::uint32_t i : used) places.emplace_back(points_[i].x, points_[i].y);
  std::vector<std::size_t> order(used.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place_of_number = CGAL::make_property_map(places);
  CGAL::hilbert_sort(
      order.begin(), order.end(),
      CGAL::Spatial_sort_traits_adapter_2<ViewKernel, decltype(place_of_number)>(place_of_number));
  std::vector<ViewVertex> vertices(points_.size());
  ViewFace near;
  for (const std::size_t i : order) {
    const ViewVertex vertex = view_.insert(places[i], near);
    vertices[used[i]] = vertex;
    near = vertex->face();
  }
  const Linked& linked = solid_.linked();
  std::size_t drawn = 0;
  for (const std::uint32_t i : faces_.seen()) {
    if (++drawn % 4096 == 0)
      progress_.at(0.2 + 0.3 * static_cast<double>(drawn) / static_cast<double>(faces_.seen().size()));
    for (std::uint32_t side = 3 * i; side < 3 * i + 3; ++side) {
      const std::uint32_t beyond = linked.opposite[side] / 3;
      if (faces_.is_seen(beyond) && beyond < i) continue;
      view_.insert_constraint(vertices[linked.from(side)], vertices[linked.to(side)]);
    }
  }
  std::uint32_t count = 0;
  for (ViewVertex vertex : view_.finite_vertex_handles()) vertex->info() = count++;
  levels_.resize(count);
}

void ShadowSurface::find_first() {
  std::vector<ViewFace> all;
  for (ViewFace face : view_.finite_face_handles()) all.push_back(face);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    const ViewFace face = all[i];
    glm::dvec2 middle(0.0);
    for (int k = 0; k < 3; ++k) middle += place_in_view(face->vertex(k)) / 3.0;
    face->info() = faces_.first_at(middle);
    // A face in the end plane has nothing behind it.
    if (face->info() == FrontFaces::none) return;
    bool is_at_end = true;
    for (int k = 0; k < 3; ++k) is_at_end = is_at_end && depth_at(face, face->vertex(k)) == end_;
    if (is_at_end) face->info() = FrontFaces::none;
  });
}

/// The depth of a face at one of its corners; the end plane's depth if the face is not covered.
double ShadowSurface::depth_at(ViewFace face, ViewVertex vertex) const {
  if (!is_covered(face)) return end_;
  const glm::dvec2 place = place_in_view(vertex);
  const auto& corners = solid_.triangles().faces[face->info()];
  double depth = std::numeric_limits<double>::quiet_NaN();
  for (const std::uint32_t corner : corners)
    if (glm::dvec2(points_[corner]) == place) depth = points_[corner].z;
  if (std::isnan(depth)) depth = faces_.depth(face->info(), place);
  return depth > end_ - same_depth_mm_ ? end_ : depth;
}

void ShadowSurface::find_levels() {
  for (ViewVertex vertex : view_.finite_vertex_handles()) {
    std::vector<double> depths;
    auto face = view_.incident_faces(vertex);
    const auto first = face;
    bool is_covered_here = false;
    do {
      depths.push_back(depth_at(face, vertex));
      is_covered_here = is_covered_here || is_covered(face);
    } while (++face != first);
    if (!is_covered_here) continue;
    depths.push_back(end_);
    std::sort(depths.begin(), depths.end());
    std::vector<Level>& own = levels_[vertex->info()];
    for (const double depth : depths) {
      if (!own.empty() && depth - own.back().to <= same_depth_mm_) {
        own.back().to = depth;
      } else {
        own.push_back({depth, depth, 0});
      }
    }
    const glm::dvec2 place = place_in_view(vertex);
    for (Level& level : own) {
      level.point = static_cast<std::uint32_t>(surface_.points_mm.size());
      // Uses the level's depth nearest to the end plane: the end plane's own depth is the only one that is
      // not computed from a triangle's plane.
      glm::dvec3 p_mm = axes_.lps({place, level.to});
      by_place_.at(place, [&](std::uint32_t i) {
        if (points_[i].z >= level.from - same_depth_mm_ && points_[i].z <= level.to + same_depth_mm_)
          p_mm = solid_.triangles().points_mm[i];
      });
      surface_.points_mm.push_back(p_mm);
    }
  }
}

std::uint32_t ShadowSurface::level_number(ViewFace face, ViewVertex vertex) const {
  const std::vector<Level>& own = levels(vertex);
  const auto found = std::lower_bound(own.begin(), own.end(), depth_at(face, vertex),
                                      [](const Level& level, double depth) { return level.to < depth; });
  return static_cast<std::uint32_t>(found - own.begin());
}

void ShadowSurface::add_caps(ViewFace face) {
  if (!is_covered(face)) return;
  std::array<std::uint32_t, 3> top, bottom;
  for (int k = 0; k < 3; ++k) {
    const ViewVertex vertex = face->vertex(k);
    top[static_cast<std::size_t>(k)] = levels(vertex)[level_number(face, vertex)].point;
    bottom[static_cast<std::size_t>(k)] = levels(vertex).back().point;
  }
  surface_.faces.push_back({top[0], top[2], top[1]});
  surface_.faces.push_back(bottom);
}

/// Adds the wall between the depths of two neighbouring faces along their common edge, through all depths
/// at either end.
void ShadowSurface::add_wall(ViewFace face, int opposite) {
  const ViewFace other = face->neighbor(opposite);
  if (!is_covered(face) && !is_covered(other)) return;
  // The face lies to the left of the way from a to b.
  const ViewVertex a = face->vertex(ViewPlane::ccw(opposite)), b = face->vertex(ViewPlane::cw(opposite));
  const std::vector<Level>&at_a = levels(a), &at_b = levels(b);
  auto i = static_cast<int>(level_number(face, a)), j = static_cast<int>(level_number(face, b));
  const auto last_i = static_cast<int>(level_number(other, a)),
             last_j = static_cast<int>(level_number(other, b));
  const int step_i = i < last_i ? 1 : -1, step_j = j < last_j ? 1 : -1;
  const auto level_of = [](const std::vector<Level>& own, int number) -> const Level& {
    return own[static_cast<std::size_t>(number)];
  };
  const double from_a = level_of(at_a, i).to, from_b = level_of(at_b, j).to;
  while (i != last_i || j != last_j) {
    const bool goes_along_a =
        j == last_j || (i != last_i && std::abs(level_of(at_a, i + step_i).to - from_a) <=
                                           std::abs(level_of(at_b, j + step_j).to - from_b));
    const std::uint32_t pa = level_of(at_a, i).point, pb = level_of(at_b, j).point;
    (goes_along_a ? i : j) += goes_along_a ? step_i : step_j;
    surface_.faces.push_back({pa, pb, goes_along_a ? level_of(at_a, i).point : level_of(at_b, j).point});
  }
}

}  // namespace

double far_end_mm(const Solid& solid, const glm::dvec3& direction) {
  const ViewAxes axes(direction);
  double far = -std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : solid.triangles().points_mm) far = std::max(far, axes.seen(p).z);
  return far;
}

Shadow shadow(const Solid& solid, const ShadowOptions& options) {
  constexpr double unit_error = 1e-9;  // of a direction that was normalised or typed with ten figures
  if (!(std::abs(glm::length(options.direction) - 1.0) < unit_error))
    throw std::invalid_argument("the direction of a shadow must be a unit vector");
  if (!std::isfinite(options.end_mm)) throw std::invalid_argument("the end of a shadow must be finite");
  if (solid.empty()) return {};
  return ShadowSurface(solid, options).made();
}

}  // namespace octotomy::brep
