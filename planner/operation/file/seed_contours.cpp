// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/seed_contours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include "brep/contour/contour.h"
#include "brep/mesh/segment.h"
#include "convert/surface/trace_contours.h"
#include "planner/operation/table/number_format.h"
#include "voxel/filter/crop.h"
#include "voxel/filter/slice_contour.h"
#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

double distance_to(const brep::Contour& contour, const glm::dvec2& p_mm) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < contour.points_mm.size(); ++i) {
    const glm::dvec2 &a = contour.points_mm[i], &b = contour.points_mm[(i + 1) % contour.points_mm.size()];
    least = std::min(least, glm::distance(p_mm, a + brep::share_along(p_mm, a, b) * (b - a)));
  }
  return least;
}

std::string words_of(const glm::dvec3& p_mm) {
  return "the seed " + plain(p_mm.x) + "," + plain(p_mm.y) + "," + plain(p_mm.z) + " mm";
}

/// The sample nearest to a seed.
glm::ivec3 sample_of(const voxel::Scene& scene, const glm::dvec3& seed_mm) {
  const glm::ivec3 at(glm::floor(scene.lattice.voxel(seed_mm) + 0.5));
  if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, scene.lattice.dims)))
    throw std::runtime_error(words_of(seed_mm) + " lies outside the scan: choose a point on an edge in it");
  return at;
}

/// Two contours of a slice that cross each other cannot both bound one object.
void need_apart(const std::vector<brep::Contour>& contours, double position_mm) {
  const auto side = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  for (std::size_t first = 0; first < contours.size(); ++first)
    for (std::size_t second = first + 1; second < contours.size(); ++second) {
      const auto &one = contours[first].points_mm, &other = contours[second].points_mm;
      for (std::size_t i = 0; i < one.size(); ++i)
        for (std::size_t j = 0; j < other.size(); ++j) {
          const glm::dvec2 a = one[i], b = one[(i + 1) % one.size()];
          const glm::dvec2 c = other[j], d = other[(j + 1) % other.size()];
          if (side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0)
            throw std::runtime_error("the slice at " + plain(position_mm) +
                                     " mm: contours of two seeds cross each other: leave one seed out");
        }
    }
}

}  // namespace

SeedContours contours_at_seeds(const voxel::Scene& scene, const std::vector<glm::dvec3>& seeds_mm) {
  SeedContours made;
  try {
    made.mask.view = voxel::parse_view(voxel::contour_view(scene.lattice));
  } catch (const voxel::InvalidInput& error) {
    throw std::runtime_error(std::string(error.what()) +
                             ": straighten the scan first, for example with octotomy prepare");
  }
  if (scene.lattice.dims.z < 2)
    throw std::runtime_error("a scan of one slice has no contours on parallel slices");
  const glm::dvec3 spacing = scene.lattice.spacing_mm();
  const auto position_of = [&](int k) {
    return glm::dot(scene.lattice.lps_mm({0, 0, k}), made.mask.view.look);
  };
  std::map<int, std::vector<brep::Contour>> by_slice;
  for (const glm::dvec3& seed_mm : seeds_mm) {
    const glm::ivec3 at = sample_of(scene, seed_mm);
    const voxel::Scene slice =
        voxel::crop(scene, {{0, 0, at.z}, {scene.lattice.dims.x - 1, scene.lattice.dims.y - 1, at.z}});
    const double threshold = voxel::interpolate(slice, {at.x, at.y, 0});
    if ((scene.padding && threshold == *scene.padding) || !std::isfinite(threshold))
      throw std::runtime_error(words_of(seed_mm) + " lies on padding, where nothing was measured");
    const std::vector<brep::Section> sections =
        convert::trace_contours(slice, threshold, std::numeric_limits<double>::infinity());
    const glm::dvec2 p_mm = glm::dvec2(at) * glm::dvec2(spacing);
    const brep::Contour* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const brep::Contour& contour : sections.front().contours)
      if (const double away = distance_to(contour, p_mm); away < least) {
        least = away;
        nearest = &contour;
      }
    if (nearest == nullptr)
      throw std::runtime_error(words_of(seed_mm) + ": its slice has no contour at " + plain(threshold));
    std::vector<brep::Contour>& of_slice = by_slice[at.z];
    if (std::none_of(of_slice.begin(), of_slice.end(),
                     [&](const brep::Contour& known) { return known.points_mm == nearest->points_mm; }))
      of_slice.push_back(*nearest);
    made.seeds.push_back(
        {seed_mm, threshold, position_of(at.z), least, least > glm::length(glm::dvec2(spacing))});
  }
  if (by_slice.begin()->first > 0) by_slice[by_slice.begin()->first - 1];
  if (by_slice.rbegin()->first + 1 < scene.lattice.dims.z) by_slice[by_slice.rbegin()->first + 1];
  for (const auto& [k, contours] : by_slice) {
    voxel::SliceMask::Slice slice;
    slice.position_mm = position_of(k);
    need_apart(contours, slice.position_mm);
    for (const brep::Contour& contour : contours) {
      slice.polygons_mm.emplace_back();
      for (const glm::dvec2& p : contour.points_mm)
        slice.polygons_mm.back().push_back(
            made.mask.view.project(scene.lattice.lps_mm({p.x / spacing.x, p.y / spacing.y, k})));
    }
    made.mask.slices.push_back(std::move(slice));
  }
  if (made.mask.slices.front().position_mm > made.mask.slices.back().position_mm)
    std::reverse(made.mask.slices.begin(), made.mask.slices.end());
  return made;
}

}  // namespace octotomy::planner
