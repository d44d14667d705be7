// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/plane_contours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tbb/parallel_for.h>
#include <utility>

#include "brep/contour/contour.h"
#include "brep/contour/cross_section.h"
#include "voxel/solid/region_mask.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

/// A plane's grid of samples: the position of the first sample, their spacing, and their numbers.
struct PlaneSamples {
  glm::dvec2 low_mm{0.0};
  double spacing_mm = 1.0;
  std::uint32_t width = 0, height = 0;
};

PlaneSamples samples_of(const voxel::Scene& scene, const ViewPlane& plane) {
  const glm::dvec3 spacing = scene.lattice.spacing_mm();
  const voxel::Box box = voxel::bounds(scene.lattice);
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec2 p = plane.view.project({corner & 1 ? box.high_mm.x : box.low_mm.x,
                                             corner & 2 ? box.high_mm.y : box.low_mm.y,
                                             corner & 4 ? box.high_mm.z : box.low_mm.z});
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  PlaneSamples samples{{}, std::min({spacing.x, spacing.y, spacing.z}), 0, 0};
  // The grid begins at a sample of the scan, so that for planes along the scan's axes all points lie on
  // samples.
  const glm::dvec2 first = plane.view.project(scene.lattice.lps_mm(glm::dvec3(0.0)));
  samples.low_mm = first + samples.spacing_mm * (glm::floor((low - first) / samples.spacing_mm) - 1.0);
  const glm::dvec2 count = glm::ceil((high - samples.low_mm) / samples.spacing_mm) + 2.0;
  if (count.x * count.y > 67108864.0)
    throw voxel::Error(voxel::ErrorCode::Resource,
                       "a plane of the scan would have more than 67 million points: resample the scan with a "
                       "coarser spacing first");
  samples.width = static_cast<std::uint32_t>(count.x);
  samples.height = static_cast<std::uint32_t>(count.y);
  return samples;
}

/// How far the sample at a point lies within the window low..high, in sample units; negative if it lies
/// outside of the window or the point outside of the scan.
float depth_at(const voxel::Scene& scene, const glm::dvec3& p_mm, double low, double high) {
  constexpr double most = 1e30;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const glm::dvec3 at = scene.lattice.voxel(p_mm), last = glm::dvec3(scene.lattice.dims) - 1.0;
  const double sample = voxel::interpolate(scene, glm::clamp(at, glm::dvec3(0.0), last));
  if (std::isnan(sample)) return static_cast<float>(-most);
  const auto depth = static_cast<float>(std::clamp(std::min(sample - low, high - sample), -most, most));
  // Outermost samples extend half a voxel outward. Beyond that, the value has the opposite sign, so that an
  // object ends half way to the next point. The value 0 counts as inside, because labels equal to a bound
  // have it; the next lower number counts as outside.
  const bool is_outside =
      glm::any(glm::lessThan(at, glm::dvec3(-0.5))) || glm::any(glm::greaterThan(at, last + 0.5));
  return is_outside ? std::nextafter(-std::abs(depth), -infinity) : depth;
}

PlaneContours points_of(std::vector<brep::Contour> contours) {
  PlaneContours polygons;
  for (brep::Contour& contour : contours)
    if (contour.closed && contour.points_mm.size() > 2) polygons.push_back(std::move(contour.points_mm));
  return polygons;
}

std::vector<brep::Contour> contours_of(const PlaneContours& polygons) {
  std::vector<brep::Contour> contours;
  for (const auto& polygon : polygons) contours.push_back({polygon});
  return contours;
}

}  // namespace

PlaneContours contours_in_plane(const voxel::Scene& scene, double low, double high, const ViewPlane& plane) {
  const PlaneSamples samples = samples_of(scene, plane);
  std::vector<float> depth(std::size_t{samples.width} * samples.height);
  tbb::parallel_for(std::uint32_t{0}, samples.height, [&](std::uint32_t j) {
    for (std::uint32_t i = 0; i < samples.width; ++i)
      depth[std::size_t{j} * samples.width + i] =
          depth_at(scene, plane.lps_mm(samples.low_mm + samples.spacing_mm * glm::dvec2(i, j)), low, high);
  });
  PlaneContours polygons = points_of(brep::follow(
      {depth, samples.width, samples.height, glm::dvec2(samples.spacing_mm)}, {.threshold = 0.0}));
  for (auto& polygon : polygons)
    for (glm::dvec2& p : polygon) p += samples.low_mm;
  return polygons;
}

PlaneContours contours_in_plane(const brep::Mesh& surface, const ViewPlane& plane, std::size_t* open) {
  // brep::Plane must be right-handed, and right x up = -look.
  brep::CrossSection section = brep::cross_section(
      surface, {plane.position_mm * plane.view.look, plane.view.right, plane.view.up, -plane.view.look});
  if (open != nullptr) *open += section.open;
  brep::part_touching(section.contours);
  return points_of(std::move(section.contours));
}

PlaneContours region_around(const PlaneContours& contours, const glm::dvec2& p_mm) {
  const std::vector<std::optional<std::size_t>> around = brep::nest(contours_of(contours));
  const std::vector<std::size_t> depth = brep::depths(around);
  std::optional<std::size_t> innermost;
  for (std::size_t i = 0; i < contours.size(); ++i)
    if (voxel::contains({contours[i]}, p_mm) && (!innermost || depth[i] > depth[*innermost])) innermost = i;
  if (!innermost || depth[*innermost] % 2 == 1) return {};
  PlaneContours region{contours[*innermost]};
  for (std::size_t i = 0; i < contours.size(); ++i)
    if (around[i] == innermost) region.push_back(contours[i]);
  return region;
}

}  // namespace octotomy::planner
