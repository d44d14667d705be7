// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <CGAL/Bbox_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_3/Robust_intersection_traits_3.h>
#include <boost/optional.hpp>
#include <boost/variant.hpp>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <tuple>
#include <utility>

#include "brep/mesh/distance.h"

namespace octotomy::convert {

/// The inside of a closed surface as a model of CGAL's concept MeshDomain_3. SurfaceTree finds the triangles,
/// and CGAL's exact predicates decide. The caller keeps surface and tree. One thread.
class SurfaceDomain {
 public:
  using R = CGAL::Exact_predicates_inexact_constructions_kernel;
  using FT = R::FT;
  using Point_3 = R::Point_3;
  using Segment_3 = R::Segment_3;
  using Ray_3 = R::Ray_3;
  using Line_3 = R::Line_3;
  using Vector_3 = R::Vector_3;
  using Sphere_3 = R::Sphere_3;
  using Has_features = CGAL::Tag_false;

  using Subdomain_index = int;
  using Subdomain = boost::optional<Subdomain_index>;
  using Surface_patch_index = std::pair<int, int>;
  using Surface_patch = boost::optional<Surface_patch_index>;
  using Index = boost::variant<Subdomain_index, Surface_patch_index>;
  using Intersection = std::tuple<Point_3, Index, int>;

  SurfaceDomain(const brep::Triangles& surface, const brep::SurfaceTree& tree)
      : surface_(surface), tree_(tree) {
    for (const glm::dvec3& p : surface.points_mm) box_ += CGAL::Bbox_3(p.x, p.y, p.z, p.x, p.y, p.z);
  }

  CGAL::Bbox_3 bbox() const { return box_; }

  auto is_in_domain_object() const {
    return [this](const Point_3& p) { return tree_.is_inside(vector_of(p)) ? Subdomain(1) : Subdomain(); };
  }

  struct Do_intersect_surface {  // NOLINT(readability-identifier-naming): CGAL asks for the names
    const SurfaceDomain& domain;
    template <typename Query>
    Surface_patch operator()(const Query& query) const {
      return domain.find(query) ? Surface_patch(patch) : Surface_patch();
    }
  };
  Do_intersect_surface do_intersect_surface_object() const { return {*this}; }

  struct Construct_intersection {  // NOLINT(readability-identifier-naming)
    const SurfaceDomain& domain;
    template <typename Query>
    Intersection operator()(const Query& query) const {
      return domain.find(query) ? Intersection(domain.common_point(query), Index(patch), 2) : Intersection();
    }
  };
  Construct_intersection construct_intersection_object() const { return {*this}; }

  Index index_from_surface_patch_index(const Surface_patch_index& index) const { return {index}; }
  Index index_from_subdomain_index(Subdomain_index index) const { return {index}; }
  Surface_patch_index surface_patch_index(const Index& index) const {
    return boost::get<Surface_patch_index>(index);
  }
  Subdomain_index subdomain_index(const Index& index) const { return boost::get<Subdomain_index>(index); }

 private:
  using Triangle = R::Triangle_3;
  using Ends = std::pair<glm::dvec3, glm::dvec3>;
  static constexpr Surface_patch_index patch{0, 1};

  static glm::dvec3 vector_of(const Point_3& p) { return {p.x(), p.y(), p.z()}; }

  /// The triangle with its last corner first, as in CGAL's surface mesh, so that intersection points are
  /// rounded in the same way.
  Triangle triangle(std::uint32_t face) const {
    const auto corner = [&](std::size_t i) {
      const glm::dvec3& p = surface_.points_mm[surface_.faces[face][i]];
      return Point_3(p.x, p.y, p.z);
    };
    return {corner(2), corner(0), corner(1)};
  }

  /// The part of a query that can meet the surface.
  Ends ends_of(const Segment_3& segment) const {
    return {vector_of(segment.source()), vector_of(segment.target())};
  }
  Ends ends_of(const Ray_3& ray) const { return ends_along(ray.source(), ray.to_vector(), 0.0); }
  Ends ends_of(const Line_3& line) const { return ends_along(line.point(), line.to_vector(), -1.0); }
  /// The part of the line from `first` to 1; the unit is a length that crosses the whole box from `from`.
  Ends ends_along(const Point_3& from, const Vector_3& along, double first) const {
    const glm::dvec3 start = vector_of(from), way(along.x(), along.y(), along.z());
    const glm::dvec3 low(box_.xmin(), box_.ymin(), box_.zmin()), high(box_.xmax(), box_.ymax(), box_.zmax());
    const double through = glm::length(glm::max(glm::abs(low - start), glm::abs(high - start)));
    const glm::dvec3 reach = 1.001 * through / glm::length(way) * way;
    return {start + first * reach, start + reach};
  }

  /// Whether a query meets the surface; then `met_` is a triangle that it meets. Mesh_3 asks for the point
  /// directly afterwards, so the result is kept.
  template <typename Query>
  bool find(const Query& query) const {
    const auto [from, to] = ends_of(query);
    if (Ends{from, to} == asked_) return has_met_;
    asked_ = {from, to};
    has_met_ = tree_.meets_any(from, to, [&](std::uint32_t face) {
      met_ = face;
      return CGAL::do_intersect(triangle(face), query);
    });
    return has_met_;
  }

  /// A point that the query shares with the triangle that it meets; the segment's source if they share a
  /// segment.
  template <typename Query>
  Point_3 common_point(const Query& query) const {
    using Exact = CGAL::Mesh_3::Robust_intersection_traits_3<R>;
    const auto common = Exact().intersect_3_object()(triangle(met_), query);
    if (common)
      if (const Point_3* point = boost::get<Point_3>(&*common)) return *point;
    if (common)
      if (const Segment_3* stretch = boost::get<Segment_3>(&*common)) return stretch->source();
    return triangle(met_).vertex(0);
  }

  const brep::Triangles& surface_;
  const brep::SurfaceTree& tree_;
  CGAL::Bbox_3 box_;
  mutable Ends asked_{glm::dvec3(0.0), glm::dvec3(0.0)};
  mutable bool has_met_ = false;
  mutable std::uint32_t met_ = 0;
};

}  // namespace octotomy::convert
