// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/slice_contour.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>

#include "voxel/filter/slice_work.h"
#include "voxel/solid/polygon.h"
#include "voxel/space/error.h"

// A contour is a closed walk over links. A link is a pair of an inside sample and one of its four neighbours
// that is outside. At each link the 2 by 2 neighbourhood of its two samples and the two samples ahead
// determines the next link:
//
//     a  b        a outside:           the next link is p's towards a   (turn left)
//     p  q        a inside, b outside: a's in p's direction             (straight on)
//                 both inside:         b's towards q                    (turn right)
//
// p is inside, q is outside, and "ahead" is a quarter turn left of the direction from p to q. Every contour
// has a link in the direction of -y. All such links of the slice are flagged once (the thesis's bit map of
// vertical pairs), and each walk clears the flags that it meets. Departure: the thesis starts from a user's
// seed; here every remaining flag is a start, so that all contours are found.

namespace octotomy::voxel {
namespace {

// Directions in order of left turns: along x, along y, against x, against y.
constexpr std::array<glm::ivec2, 4> steps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
constexpr int against_y = 3;

struct Link {
  glm::ivec2 p{0};
  int direction = 0;
  bool operator==(const Link&) const = default;
};

class Follower {
 public:
  Follower(const Scene& scene, int k, double threshold)
      : size_(scene.lattice.dims.x, scene.lattice.dims.y), threshold_(threshold) {
    if (k < 0 || k >= scene.lattice.dims.z)
      throw InvalidInput("there is no slice " + std::to_string(k) + " of " +
                         std::to_string(scene.lattice.dims.z));
    if (!std::isfinite(threshold)) throw InvalidInput("a contour's threshold must be a finite number");
    const std::size_t area = static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y);
    values_.resize(area);
    std::visit(
        [&](const auto& samples) {
          for (std::size_t i = 0; i < area; ++i)
            values_[i] = static_cast<double>(samples[area * static_cast<std::size_t>(k) + i]);
        },
        scene.samples);
  }

  bool inside(const glm::ivec2& p) const { return held(p) && value(p) >= threshold_; }

  std::vector<SliceContour> all() {
    std::vector<bool> flagged(values_.size());
    for (int y = 0; y < size_.y; ++y)
      for (int x = 0; x < size_.x; ++x)
        flagged[index({x, y})] = inside({x, y}) && !inside(glm::ivec2(x, y) + steps[against_y]);
    std::vector<SliceContour> contours;
    for (int y = 0; y < size_.y; ++y)
      for (int x = 0; x < size_.x; ++x)
        if (flagged[index({x, y})])
          contours.push_back(follow({{x, y}, against_y}, [&](const Link& link) {
            if (link.direction == against_y) flagged[index(link.p)] = false;
          }));
    return contours;
  }

  template <typename Met>
  SliceContour follow(const Link& start, const Met& met) const {
    SliceContour contour;
    Link link = start;
    do {
      met(link);
      contour.push_back(point(link));
      link = next(link);
    } while (link != start);
    return contour;
  }

 private:
  bool held(const glm::ivec2& p) const { return p.x >= 0 && p.y >= 0 && p.x < size_.x && p.y < size_.y; }
  std::size_t index(const glm::ivec2& p) const {
    return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(p.x);
  }
  double value(const glm::ivec2& p) const { return values_[index(p)]; }

  Link next(const Link& link) const {
    assert(inside(link.p) && !inside(link.p + steps[static_cast<std::size_t>(link.direction)]));
    const int left = (link.direction + 1) % 4;
    const glm::ivec2 a = link.p + steps[static_cast<std::size_t>(left)];
    if (!inside(a)) return {link.p, left};
    const glm::ivec2 b = a + steps[static_cast<std::size_t>(link.direction)];
    if (!inside(b)) return {a, link.direction};
    return {b, (link.direction + 3) % 4};
  }

  glm::dvec2 point(const Link& link) const {
    const glm::ivec2 step = steps[static_cast<std::size_t>(link.direction)];
    const glm::ivec2 q = link.p + step;
    double part = 0.5;
    if (held(q)) part = (value(link.p) - threshold_) / (value(link.p) - value(q));
    return glm::dvec2(link.p) + part * glm::dvec2(step);
  }

  glm::ivec2 size_;
  double threshold_;
  std::vector<double> values_;
};

// The patient axis that is normal to a lattice's slices.
int slice_axis(const Lattice& lattice) {
  const glm::dvec3 normal = glm::normalize(
      glm::cross(glm::dvec3(lattice.lps_from_voxel[0]), glm::dvec3(lattice.lps_from_voxel[1])));
  // An error of a tenth of a degree shifts a position 300 mm away by half a millimetre.
  const double least = std::cos(0.1 * std::numbers::pi / 180.0);
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(normal[axis]) >= least) return axis;
  throw InvalidInput(
      "regions need slices across one of the patient's axes, and these slices are oblique: resample the scan "
      "along the patient's axes first");
}

}  // namespace

std::vector<SliceContour> slice_contours(const Scene& scene, int k, double threshold) {
  check(scene);
  return Follower(scene, k, threshold).all();
}

SliceContour thinned(const SliceContour& contour, double most) {
  const std::size_t count = contour.size();
  if (count < 4) return contour;
  const auto at = [&](std::size_t i) { return contour[i % count]; };
  // The first point and the point farthest from it are kept.
  std::size_t opposite = 1;
  for (std::size_t i = 1; i < count; ++i)
    if (glm::distance(contour[i], contour[0]) > glm::distance(contour[opposite], contour[0])) opposite = i;
  std::vector<bool> kept(count, false);
  kept[0] = kept[opposite] = true;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, opposite}, {opposite, count}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    double farthest = most;
    std::size_t split = from;
    for (std::size_t i = from + 1; i < to; ++i)
      if (const double away = std::sqrt(square_to_segment(at(i), at(from), at(to))); away > farthest)
        farthest = away, split = i;
    if (split == from) continue;
    kept[split] = true;
    open.emplace_back(from, split);
    open.emplace_back(split, to);
  }
  SliceContour result;
  for (std::size_t i = 0; i < count; ++i)
    if (kept[i]) result.push_back(contour[i]);
  return result;
}

std::string contour_view(const Lattice& lattice) {
  constexpr std::array<const char*, 3> names{"right", "anterior", "inferior"};  // looking along +x, +y, +z
  return names[static_cast<std::size_t>(slice_axis(lattice))];
}

SliceMask contour_regions(const Scene& scene, const ContourOptions& options) {
  check(scene);
  SliceMask mask;
  mask.view = parse_view(contour_view(scene.lattice));
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const double least = options.least_mm2 / (spacing_mm.x * spacing_mm.y);
  const int slices = scene.lattice.dims.z;
  mask.slices.resize(static_cast<std::size_t>(slices));
  for_each_slice(slices, options.progress, [&](int k) {
    SliceMask::Slice& slice = mask.slices[static_cast<std::size_t>(k)];
    slice.position_mm = glm::dot(scene.lattice.lps_mm({0, 0, k}), mask.view.look);
    for (const SliceContour& contour : slice_contours(scene, k, options.threshold)) {
      const SliceContour thin = thinned(contour, options.thin);
      // If a sample equals the threshold, the points on all its links coincide.
      if (thin.size() < 3 || std::abs(signed_area(thin)) <= least) continue;
      std::vector<glm::dvec2>& polygon = slice.polygons_mm.emplace_back();
      for (const glm::dvec2& p : thin)
        polygon.push_back(mask.view.project(scene.lattice.lps_mm({p.x, p.y, k})));
    }
  });
  if (std::all_of(mask.slices.begin(), mask.slices.end(),
                  [](const SliceMask::Slice& slice) { return slice.polygons_mm.empty(); }))
    throw Error(ErrorCode::Geometry, "no contour was found at " + std::to_string(options.threshold) +
                                         ": choose another threshold or a smaller minimum area");
  std::sort(mask.slices.begin(), mask.slices.end(), [](const SliceMask::Slice& a, const SliceMask::Slice& b) {
    return a.position_mm < b.position_mm;
  });
  return mask;
}

}  // namespace octotomy::voxel
