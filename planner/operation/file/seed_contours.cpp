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
#include "planner/operation/file/plane_contours.h"
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

/// The indices of the sample nearest to a seed. Throws if the seed lies outside of the scan.
glm::ivec3 sample_of(const voxel::Scene& scene, const glm::dvec3& seed_mm) {
  const glm::ivec3 at(glm::floor(scene.lattice.voxel(seed_mm) + 0.5));
  if (glm::any(glm::lessThan(at, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(at, scene.lattice.dims)))
    throw std::runtime_error(words_of(seed_mm) + " lies outside of the scan: choose a point within it");
  return at;
}

/// Throws if two contours of a slice cross each other, because they cannot both bound one object.
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
            throw std::runtime_error(
                "the slice at " + plain(position_mm) +
                " mm: contours of two seeds cross each other: leave out one of the seeds");
        }
    }
}

/// Collects the contours of seeds' slices as a mask.
class SeededSlices {
 public:
  explicit SeededSlices(const voxel::Scene& scene) : scene_(scene), spacing_(scene.lattice.spacing_mm()) {
    try {
      made_.mask.view = voxel::parse_view(voxel::contour_view(scene.lattice));
    } catch (const voxel::InvalidInput& error) {
      throw std::runtime_error(std::string(error.what()) +
                               ": straighten the scan first, for example by octotomy prepare");
    }
    if (scene.lattice.dims.z < 2)
      throw std::runtime_error("the scan has one slice, but contours on parallel slices need at least two");
  }

  /// A seed's nearest sample, and the slice in which it lies.
  struct Place {
    glm::ivec3 at{0};
    double sample = 0.0;
    glm::dvec2 p_mm{0.0};  ///< in mm within the slice, from its first sample
    voxel::Scene slice;
  };
  Place place_of(const glm::dvec3& seed_mm) const {
    const glm::ivec3 at = sample_of(scene_, seed_mm);
    voxel::Scene slice =
        voxel::crop(scene_, {{0, 0, at.z}, {scene_.lattice.dims.x - 1, scene_.lattice.dims.y - 1, at.z}});
    const double sample = voxel::interpolate(slice, {at.x, at.y, 0});
    if ((scene_.padding && sample == *scene_.padding) || !std::isfinite(sample))
      throw std::runtime_error(words_of(seed_mm) +
                               " lies on padding, where nothing was measured: choose another point");
    return {at, sample, glm::dvec2(at) * glm::dvec2(spacing_), std::move(slice)};
  }

  double away_mm(const std::vector<brep::Contour>& contours, const glm::dvec2& p_mm) const {
    double least = std::numeric_limits<double>::infinity();
    for (const brep::Contour& contour : contours) least = std::min(least, distance_to(contour, p_mm));
    return least;
  }

  /// Adds a seed and those of its contours that its slice does not have yet.
  void add(const glm::dvec3& seed_mm, const Place& place, double threshold,
           const std::vector<brep::Contour>& contours, bool must_be_near) {
    std::vector<brep::Contour>& of_slice = by_slice_[place.at.z];
    for (const brep::Contour& contour : contours)
      if (std::none_of(of_slice.begin(), of_slice.end(),
                       [&](const brep::Contour& known) { return known.points_mm == contour.points_mm; }))
        of_slice.push_back(contour);
    const double away = away_mm(contours, place.p_mm);
    made_.seeds.push_back({seed_mm, threshold, position_of(place.at.z), away,
                           must_be_near && away > glm::length(glm::dvec2(spacing_))});
  }

  /// Precondition: a seed was added.
  SeedContours finished() && {
    if (by_slice_.begin()->first > 0) by_slice_[by_slice_.begin()->first - 1];
    if (by_slice_.rbegin()->first + 1 < scene_.lattice.dims.z) by_slice_[by_slice_.rbegin()->first + 1];
    for (const auto& [k, contours] : by_slice_) {
      voxel::SliceMask::Slice slice;
      slice.position_mm = position_of(k);
      need_apart(contours, slice.position_mm);
      for (const brep::Contour& contour : contours) {
        slice.polygons_mm.emplace_back();
        for (const glm::dvec2& p : contour.points_mm)
          slice.polygons_mm.back().push_back(
              made_.mask.view.project(scene_.lattice.lps_mm({p.x / spacing_.x, p.y / spacing_.y, k})));
      }
      made_.mask.slices.push_back(std::move(slice));
    }
    if (made_.mask.slices.front().position_mm > made_.mask.slices.back().position_mm)
      std::reverse(made_.mask.slices.begin(), made_.mask.slices.end());
    return std::move(made_);
  }

 private:
  double position_of(int k) const { return glm::dot(scene_.lattice.lps_mm({0, 0, k}), made_.mask.view.look); }

  const voxel::Scene& scene_;
  glm::dvec3 spacing_;
  SeedContours made_;
  std::map<int, std::vector<brep::Contour>> by_slice_;
};

}  // namespace

SeedContours contours_at_seeds(const voxel::Scene& scene, const std::vector<glm::dvec3>& seeds_mm) {
  SeededSlices slices(scene);
  for (const glm::dvec3& seed_mm : seeds_mm) {
    const SeededSlices::Place place = slices.place_of(seed_mm);
    const std::vector<brep::Section> sections =
        convert::trace_contours(place.slice, place.sample, std::numeric_limits<double>::infinity());
    const brep::Contour* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const brep::Contour& contour : sections.front().contours)
      if (const double away = distance_to(contour, place.p_mm); away < least) {
        least = away;
        nearest = &contour;
      }
    if (nearest == nullptr)
      throw std::runtime_error(words_of(seed_mm) +
                               ": no contour of its slice has the seed's sample as threshold, " +
                               plain(place.sample));
    slices.add(seed_mm, place, place.sample, {*nearest}, true);
  }
  return std::move(slices).finished();
}

SeedContours contours_around_seeds(const voxel::Scene& scene, const std::vector<glm::dvec3>& seeds_mm,
                                   const RegionSamples& samples) {
  SeededSlices slices(scene);
  for (const glm::dvec3& seed_mm : seeds_mm) {
    const SeededSlices::Place place = slices.place_of(seed_mm);
    const double low = samples.window ? samples.window->low : place.sample - *samples.tolerance;
    const double high =
        samples.window ? samples.window->high_or_infinity() : place.sample + *samples.tolerance;
    if (place.sample < low || place.sample > high)
      throw std::runtime_error(words_of(seed_mm) + " lies outside of the window, because its sample is " +
                               plain(place.sample) + ": choose another seed or window");
    PlaneContours all;
    const std::vector<brep::Section> sections = convert::trace_contours(place.slice, low, high);
    for (const brep::Contour& contour : sections.front().contours) all.push_back(contour.points_mm);
    std::vector<brep::Contour> region;
    for (auto& polygon : region_around(all, place.p_mm)) region.push_back({std::move(polygon)});
    if (region.empty())
      throw std::runtime_error(words_of(seed_mm) +
                               " lies on the border of the region: choose a seed inside the region");
    slices.add(seed_mm, place, low, region, false);
  }
  return std::move(slices).finished();
}

}  // namespace octotomy::planner
