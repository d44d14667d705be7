// SPDX-License-Identifier: AGPL-3.0-or-later
// 1. Compute path lengths through the voxels from the beginning, by Dijkstra's algorithm on 26 neighbours.
// 2. The centres of shells of equal path length form the centre line; it is smoothed by a Gaussian as wide as
// the passage.
// 3. At even steps, cut the plane perpendicular to the line in both kernels and keep the part around the
// line.
#include "planner/operation/measure/airway_sections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "brep/contour/cross_section.h"
#include "voxel/measure/distance_map.h"
#include "voxel/solid/polygon.h"
#include "voxel/solid/region_mask.h"
#include "voxel/view/reformat.h"

namespace octotomy::planner {
namespace {

constexpr double nearest_end_mm = 5.0;

/// Path lengths from one voxel through a passage to its other voxels.
class Ways {
 public:
  explicit Ways(const voxel::Octree& octree)
      : octree_(octree), range_(voxel::range_of(octree)), dims_(range_.dims()) {
    if (range_.is_empty()) throw std::runtime_error("the passage is empty");
    ways_mm_.assign(static_cast<std::size_t>(dims_.x) * static_cast<std::size_t>(dims_.y) *
                        static_cast<std::size_t>(dims_.z),
                    infinite);
  }

  /// The voxel of the passage that is nearest to a point. Throws if it is farther than nearest_end_mm.
  glm::ivec3 nearest(const glm::dvec3& p_mm) const {
    const voxel::Lattice lattice = octree_.universe().lattice();
    glm::ivec3 best(0);
    double least = infinite;
    each([&](const glm::ivec3& v) {
      if (const double distance = glm::distance(lattice.lps_mm(v), p_mm); distance < least)
        least = distance, best = v;
    });
    if (least > nearest_end_mm)
      throw std::runtime_error(
          "the passage is farther than 5 mm from one of its two end points: choose points within the "
          "passage");
    return best;
  }

  /// Computes the path length from a voxel to every other voxel of the passage.
  void walk_from(const glm::ivec3& start) {
    const glm::dmat3 axes(octree_.universe().lps_from_voxel);
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    ways_mm_[index(start)] = 0.0;
    open.emplace(0.0, index(start));
    while (!open.empty()) {
      const auto [way_mm, at] = open.top();
      open.pop();
      if (way_mm > ways_mm_[at]) continue;
      const glm::ivec3 v = voxel_of(at);
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x) {
            const glm::ivec3 next = v + glm::ivec3(x, y, z);
            if (next == v || !is_in(next) || !octree_.contains(next)) continue;
            const double to_mm = way_mm + glm::length(axes * glm::dvec3(x, y, z));
            if (to_mm < ways_mm_[index(next)]) open.emplace(ways_mm_[index(next)] = to_mm, index(next));
          }
    }
  }
  double way_mm(const glm::ivec3& v) const { return ways_mm_[index(v)]; }

  template <typename Each>
  void each(const Each& visit) const {
    glm::ivec3 v;
    for (v.z = range_.low.z; v.z <= range_.high.z; ++v.z)
      for (v.y = range_.low.y; v.y <= range_.high.y; ++v.y)
        for (v.x = range_.low.x; v.x <= range_.high.x; ++v.x)
          if (octree_.contains(v)) visit(v);
  }
  static constexpr double infinite = std::numeric_limits<double>::infinity();

 private:
  bool is_in(const glm::ivec3& v) const {
    return glm::all(glm::greaterThanEqual(v, range_.low)) && glm::all(glm::lessThanEqual(v, range_.high));
  }
  std::size_t index(const glm::ivec3& voxel) const {
    const glm::ivec3 v = voxel - range_.low;
    return static_cast<std::size_t>(v.x) +
           static_cast<std::size_t>(dims_.x) *
               (static_cast<std::size_t>(v.y) +
                static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(v.z));
  }
  glm::ivec3 voxel_of(std::size_t at) const {
    const auto x = static_cast<std::size_t>(dims_.x), y = static_cast<std::size_t>(dims_.y);
    return range_.low +
           glm::ivec3(static_cast<int>(at % x), static_cast<int>(at / x % y), static_cast<int>(at / (x * y)));
  }

  const voxel::Octree& octree_;
  voxel::VoxelRange range_;
  glm::ivec3 dims_;
  std::vector<double> ways_mm_;
};

/// The centres of shells of equal path length, their distance along the path, and the passage's mean width.
struct RawLine {
  std::vector<glm::dvec3> points_mm;
  double apart_mm = 1.0, width_mm = 1.0;
};

RawLine raw_line(const voxel::Octree& octree, const glm::dvec3& from_mm, const glm::dvec3& to_mm) {
  const voxel::Lattice lattice = octree.universe().lattice();
  Ways ways(octree);
  const glm::ivec3 end = ways.nearest(to_mm);
  ways.walk_from(ways.nearest(from_mm));
  const double length_mm = ways.way_mm(end);
  if (!std::isfinite(length_mm))
    throw std::runtime_error(
        "no path through the passage connects its two ends: check that the object contains the whole "
        "passage");
  RawLine line;
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  line.apart_mm = 1.5 * std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const auto count = static_cast<std::size_t>(std::ceil(length_mm / line.apart_mm));
  std::vector<glm::dvec3> sums(count, glm::dvec3(0.0));
  std::vector<double> voxels(count, 0.0);
  ways.each([&](const glm::ivec3& v) {
    const double shell = std::floor(ways.way_mm(v) / line.apart_mm);
    if (!(shell < static_cast<double>(count))) return;
    sums[static_cast<std::size_t>(shell)] += lattice.lps_mm(v);
    voxels[static_cast<std::size_t>(shell)] += 1.0;
  });
  double all = 0.0;
  for (std::size_t i = 0; i < count; ++i)
    if (voxels[i] > 0.0) line.points_mm.push_back(sums[i] / voxels[i]), all += voxels[i];
  line.width_mm = 2.0 * std::sqrt(all * lattice.voxel_mm3() / (std::numbers::pi * std::max(length_mm, 1e-9)));
  if (line.points_mm.size() < 4 || length_mm < line.width_mm)
    throw std::runtime_error(
        "the path between the ends is shorter than the passage is wide: choose end points farther apart");
  return line;
}

/// The line of best fit to the points around a place, with Gaussian weights: its point and its direction
/// there. Unlike a mean of the points, it is not shifted inward at the ends.
struct Station {
  glm::dvec3 at_mm{0.0}, direction{0.0};
};
Station fitted(const RawLine& line, double place) {
  const double sigma = 0.5 * line.width_mm / line.apart_mm;
  double w0 = 0.0, w1 = 0.0, w2 = 0.0;
  glm::dvec3 p0(0.0), p1(0.0);
  for (std::size_t i = 0; i < line.points_mm.size(); ++i) {
    const double t = static_cast<double>(i) - place, w = std::exp(-0.5 * t * t / (sigma * sigma));
    w0 += w, w1 += w * t, w2 += w * t * t;
    p0 += w * line.points_mm[i], p1 += w * t * line.points_mm[i];
  }
  const double determinant = w0 * w2 - w1 * w1;
  return {(w2 * p0 - w1 * p1) / determinant, glm::normalize((w0 * p1 - w1 * p0) / determinant)};
}

/// Sets the area and perimeter of the connected part of the octree's section that contains the plane's origin
/// or is nearest to it.
void cut_voxels(const voxel::Octree& octree, const brep::Plane& plane, double reach_mm, AirwaySection& made) {
  const glm::dvec3 spacing_mm = octree.universe().lattice().spacing_mm();
  voxel::Sheet sheet;
  sheet.pixel_mm = 0.25 * std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const int half = static_cast<int>(std::min(2000.0, std::ceil(reach_mm / sheet.pixel_mm)));
  const int side = 2 * half + 1;
  sheet.down = -plane.up;
  sheet.height_px = side;
  for (int column = -half; column <= half; ++column)
    sheet.columns_mm.push_back(plane.origin_mm + plane.right * (column * sheet.pixel_mm) +
                               plane.up * (half * sheet.pixel_mm));
  std::vector<std::uint8_t> inside = voxel::cut(octree, sheet);
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x);
  };
  // The nearest pixel inside is used, because the line may miss a thin or bent section.
  std::optional<glm::ivec2> seed;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      if (inside[at(x, y)] != 0 &&
          (!seed || std::hypot(x - half, y - half) < std::hypot(seed->x - half, seed->y - half)))
        seed = glm::ivec2(x, y);
  if (!seed) return;
  std::vector<glm::ivec2> open{*seed};
  inside[at(seed->x, seed->y)] = 2;
  std::size_t pixels = 0, edges = 0;
  while (!open.empty()) {
    const glm::ivec2 p = open.back();
    open.pop_back();
    ++pixels;
    for (const glm::ivec2& by : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
      const glm::ivec2 q = p + by;
      const bool is_in = q.x >= 0 && q.y >= 0 && q.x < side && q.y < side;
      if (!is_in || inside[at(q.x, q.y)] == 0) {
        ++edges;
      } else if (inside[at(q.x, q.y)] == 1) {
        inside[at(q.x, q.y)] = 2;
        open.push_back(q);
      }
    }
  }
  made.voxel_mm2 = static_cast<double>(pixels) * sheet.pixel_mm * sheet.pixel_mm;
  // The edges of pixels overestimate a round outline by 4 / pi.
  made.perimeter_mm = static_cast<double>(edges) * sheet.pixel_mm * std::numbers::pi / 4.0;
}

/// The area of the mesh's section in mm2: of the contour around the plane's origin, or else of the nearest
/// one, minus its holes. None without a closed contour.
std::optional<double> cut_mesh(const brep::Solid& solid, const brep::Plane& plane) {
  const brep::CrossSection section = brep::cross_section(solid, plane);
  const brep::Contour* about = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const brep::Contour& contour : section.contours) {
    const std::vector<glm::dvec2>& points = contour.points_mm;
    if (!contour.closed || points.size() < 3 || !(voxel::signed_area(points) > 0.0)) continue;
    double distance =
        voxel::contains({points}, glm::dvec2(0.0)) ? 0.0 : std::numeric_limits<double>::infinity();
    if (distance > 0.0)
      for (const glm::dvec2& p : points) distance = std::min(distance, glm::length(p));
    if (distance < least) least = distance, about = &contour;
  }
  if (about == nullptr) return std::nullopt;
  double area = voxel::signed_area(about->points_mm);
  for (const brep::Contour& hole : section.contours)
    if (const std::vector<glm::dvec2>& points = hole.points_mm;
        hole.closed && points.size() >= 3 && voxel::signed_area(points) < 0.0 &&
        voxel::contains({about->points_mm}, points.front()))
      area += voxel::signed_area(points);
  return area;
}

}  // namespace

AirwaySections airway_sections(const voxel::Octree& octree, const std::optional<brep::Solid>& solid,
                               const glm::dvec3& from_mm, const glm::dvec3& to_mm, double step_mm) {
  const RawLine line = raw_line(octree, from_mm, to_mm);
  AirwaySections made;
  std::vector<Station> stations;
  const double step = std::min(1.0, 0.1 * step_mm / line.apart_mm);
  for (double place = 0.0; place <= static_cast<double>(line.points_mm.size() - 1); place += step)
    stations.push_back(fitted(line, place));
  double along_mm = 0.0, last_mm = -step_mm;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    if (i > 0) along_mm += glm::distance(stations[i].at_mm, stations[i - 1].at_mm);
    if (along_mm - last_mm < step_mm * (1.0 - 1e-9)) continue;
    last_mm = along_mm;
    AirwaySection section{along_mm, stations[i].at_mm, stations[i].direction, 0.0, 0.0, {}};
    const brep::Plane plane = brep::plane_through(section.at_mm, section.direction);
    cut_voxels(octree, plane, 3.0 * line.width_mm, section);
    if (!(section.voxel_mm2 > 0.0)) continue;
    if (solid && !solid->empty()) section.mesh_mm2 = cut_mesh(*solid, plane);
    made.sections.push_back(section);
  }
  made.length_mm = along_mm;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < made.sections.size(); ++i) {
    const AirwaySection& section = made.sections[i];
    const double radius_mm = std::sqrt(section.area_mm2() / std::numbers::pi);
    if (std::min(section.along_mm, along_mm - section.along_mm) < radius_mm) continue;
    if (section.area_mm2() < least) least = section.area_mm2(), made.narrowest = i;
  }
  if (!std::isfinite(least))
    throw std::runtime_error(
        "the path between the ends is shorter than the passage is wide: choose end points farther apart");
  return made;
}

HalfWidth section_half_width(const AirwaySection& section, const Digitised& digitised) {
  HalfWidth width;
  // 99 % of normally distributed errors are within 2.576 standard deviations. A uniformly distributed
  // position within a step has a twelfth of the step's square as variance.
  const auto add_steps = [&](const char* name, const glm::dvec3& step_mm) {
    const double h = std::max({step_mm.x, step_mm.y, step_mm.z});
    width.terms.push_back(
        {name, "2.6 h sqrt(P h / 12)", 2.6 * h * std::sqrt(section.perimeter_mm * h / 12.0)});
  };
  add_steps("voxels", digitised.voxel_mm);
  if (digitised.sample_mm != glm::dvec3(0.0)) add_steps("samples", digitised.sample_mm);
  if (digitised.shift_mm)
    width.terms.push_back({"window", "P shift", section.perimeter_mm * *digitised.shift_mm});
  double squares = 0.0;
  for (const Doubt& term : width.terms) squares += term.half_width * term.half_width;
  width.value = std::sqrt(squares);
  return width;
}

}  // namespace octotomy::planner
