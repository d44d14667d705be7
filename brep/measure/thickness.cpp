// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 cast a ray inward from each point; 2 start with the ball through the point whose diameter is the ray's
// length; 3 while the surface point nearest to its centre lies in the ball and on another sheet, replace the
// ball by the one through both points. All balls shrink together, one step per round, so that nearest points
// are found in parallel.
#include "brep/measure/thickness.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, std::vector<Kernel::Triangle_3>::const_iterator>;
using RayTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

/// The distance inward at which a ray starts, so that it does not hit the sheet it leaves, and the tolerance
/// of a ball's diameter. It is far above the rounding of points, 2^-52 of their coordinates, and far below
/// any measured thickness.
double step_mm(const Size& size) {
  return 0x1p-30 * glm::length(size.high_mm - size.low_mm);
}

Kernel::Point_3 cgal_of(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}

/// The length along the ray from each point to the surface.
class Rays {
 public:
  Rays(const Triangles& surface, double step) : step_mm_(step) {
    for (const auto& face : surface.faces)
      triangles_.emplace_back(cgal_of(surface.points_mm[face[0]]), cgal_of(surface.points_mm[face[1]]),
                              cgal_of(surface.points_mm[face[2]]));
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.build();
  }

  double length_mm(const SurfacePoint& point) const {
    const glm::dvec3 start = point.p_mm - step_mm_ * point.normal;
    const Kernel::Ray_3 ray(cgal_of(start),
                            Kernel::Vector_3(-point.normal.x, -point.normal.y, -point.normal.z));
    const auto hit = tree_.first_intersection(ray);
    if (!hit) return std::numeric_limits<double>::infinity();
    const Kernel::Point_3* at = boost::get<Kernel::Point_3>(&hit->first);
    // The ray runs in the plane of a triangle, within the surface.
    if (at == nullptr) return 0.0;
    return step_mm_ + glm::distance(start, glm::dvec3(at->x(), at->y(), at->z()));
  }

 private:
  double step_mm_;
  std::vector<Kernel::Triangle_3> triangles_;
  RayTree tree_;
};

/// Computes the diameters of the balls from upper bounds.
void shrink(const SurfaceTree& tree, const std::vector<SurfacePoint>& points, double step,
            double least_cosine, const ThicknessOptions& options, std::vector<Thickness>& thickness) {
  assert(thickness.size() == points.size() && step > 0.0);
  std::vector<std::size_t> shrinking(points.size());
  std::iota(shrinking.begin(), shrinking.end(), std::size_t{0});
  const auto centre_of = [&](std::size_t i) {
    return points[i].p_mm - 0.5 * thickness[i].ball_mm * points[i].normal;
  };
  while (!shrinking.empty()) {
    if (options.stop.stop_requested()) throw Stopped("thickness: stopped");
    std::vector<glm::dvec3> centres;
    centres.reserve(shrinking.size());
    for (const std::size_t i : shrinking) centres.push_back(centre_of(i));
    const std::vector<Foot> feet = tree.feet(centres);
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < shrinking.size(); ++k) {
      const std::size_t i = shrinking[k];
      const double radius = 0.5 * thickness[i].ball_mm;
      assert(std::isfinite(radius) && radius >= 0.0);
      if (feet[k].distance_mm >= radius - step) continue;
      const glm::dvec3 to_foot = points[i].p_mm - feet[k].p_mm, from_centre = points[i].p_mm - centres[k];
      const double cosine = glm::dot(from_centre, feet[k].p_mm - centres[k]) /
                            (glm::length(from_centre) * std::max(feet[k].distance_mm, step));
      const double depth = glm::dot(to_foot, points[i].normal);
      if (cosine > least_cosine || !(depth > 0.0)) continue;
      thickness[i].ball_mm = glm::dot(to_foot, to_foot) / depth;
      if (thickness[i].ball_mm < 2.0 * radius - step) still.push_back(i);
    }
    if (options.progress)
      options.progress(1.0 - 0.5 * static_cast<double>(still.size()) / static_cast<double>(points.size()));
    shrinking = std::move(still);
  }
}

}  // namespace

std::vector<Thickness> thickness(const Solid& solid, const std::vector<SurfacePoint>& points,
                                 const ThicknessOptions& options) {
  if (solid.empty()) throw std::invalid_argument("thickness: the solid has no triangles");
  if (!(options.least_angle_deg >= 1.0 && options.least_angle_deg <= 120.0))
    throw std::invalid_argument("thickness: the least angle is from 1 to 120 degrees");
  const double step = step_mm(solid.size());
  const Rays rays(solid.triangles(), step);
  std::vector<Thickness> thickness(points.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
    if (options.stop.stop_requested()) return;
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const double length = rays.length_mm(points[i]);
      thickness[i] = {length, length};
    }
  });
  if (options.stop.stop_requested()) throw Stopped("thickness: stopped");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::isfinite(thickness[i].ray_mm))
      throw std::invalid_argument("thickness: the ray from point " + std::to_string(i) +
                                  " leaves without meeting the surface; it is not closed, or the normal does "
                                  "not point out of it");
  shrink(solid.tree(), points, step, std::cos(options.least_angle_deg * std::numbers::pi / 180.0), options,
         thickness);
  return thickness;
}

}  // namespace octotomy::brep
