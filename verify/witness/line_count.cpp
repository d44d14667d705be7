// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/line_count.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tbb/parallel_for.h>

#include "verify/phantom/chance.h"

namespace octotomy::verify {
namespace {

constexpr std::size_t directions = 12;

/// Returns directions that are spread evenly over a hemisphere by the golden angle, then turned at random.
std::array<glm::dvec3, directions> spread_directions(Chance& chance) {
  // The turn is a random unit quaternion (Shoemake 1992).
  const double s = chance.between(0.0, 1.0), a = 2.0 * std::numbers::pi * chance.between(0.0, 1.0),
               b = 2.0 * std::numbers::pi * chance.between(0.0, 1.0);
  const double x = std::sqrt(1.0 - s) * std::sin(a), y = std::sqrt(1.0 - s) * std::cos(a),
               z = std::sqrt(s) * std::sin(b), w = std::sqrt(s) * std::cos(b);
  const glm::dmat3 turn(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y),
                        2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
                        2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y));
  std::array<glm::dvec3, directions> made;
  for (std::size_t i = 0; i < directions; ++i) {
    const double height = (static_cast<double>(i) + 0.5) / directions;
    const double around = static_cast<double>(i) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double radius = std::sqrt(1.0 - height * height);
    made[i] = turn * glm::dvec3(radius * std::cos(around), radius * std::sin(around), height);
  }
  return made;
}

/// Parallel lines through a box: its projection along their direction.
struct Bundle {
  glm::dvec3 along, right, up;
  glm::dvec3 low{0.0};  ///< in coordinates right, up, along
  double cell_mm = 1.0, reach_mm = 0.0;
  std::size_t columns = 0, rows = 0;

  Line line(std::size_t i) const {
    const double x = low.x + cell_mm * static_cast<double>(i % columns),
                 y = low.y + cell_mm * static_cast<double>(i / columns);
    return {x * right + y * up + low.z * along, along};
  }
};

Bundle bundle_of(const voxel::Box& box, const glm::dvec3& along, double lines, Chance& chance) {
  Bundle made;
  made.along = along;
  const glm::dvec3 aside = std::abs(along.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  made.right = glm::normalize(glm::cross(aside, along));
  made.up = glm::cross(along, made.right);
  glm::dvec3 low(1e300), high(-1e300);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? box.high_mm.x : box.low_mm.x, corner & 2 ? box.high_mm.y : box.low_mm.y,
                       corner & 4 ? box.high_mm.z : box.low_mm.z);
    const glm::dvec3 q(glm::dot(p, made.right), glm::dot(p, made.up), glm::dot(p, along));
    low = glm::min(low, q);
    high = glm::max(high, q);
  }
  const glm::dvec3 extent = high - low;
  made.cell_mm = std::sqrt(extent.x * extent.y / lines);
  made.low = low + glm::dvec3(chance.between(0.0, made.cell_mm), chance.between(0.0, made.cell_mm), 0.0);
  made.columns =
      static_cast<std::size_t>(std::max(0.0, std::floor((high.x - made.low.x) / made.cell_mm))) + 1;
  made.rows = static_cast<std::size_t>(std::max(0.0, std::floor((high.y - made.low.y) / made.cell_mm))) + 1;
  made.reach_mm = extent.z;
  return made;
}

/// The length of one line inside the object, and the number of its crossings of the surface.
struct Reached {
  double length_mm = 0.0;
  std::uint64_t crossings = 0;
};

}  // namespace

LineCount count_along_lines(const LineReading& reading, const LineCountOptions& options) {
  voxel::Box box = reading.box_mm;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isinf(box.low_mm[axis])) box.low_mm[axis] = options.world_mm.low_mm[axis];
    if (std::isinf(box.high_mm[axis])) box.high_mm[axis] = options.world_mm.high_mm[axis];
  }
  LineCount count;
  if (glm::any(glm::lessThanEqual(box.high_mm, box.low_mm))) return count;
  Chance chance(options.seed);
  std::array<double, directions> volumes_mm3{};
  double areas_mm2 = 0.0;
  std::size_t number = 0;
  for (const glm::dvec3& along : spread_directions(chance)) {
    const Bundle bundle = bundle_of(box, along, static_cast<double>(options.lines) / directions, chance);
    std::vector<Reached> reached(bundle.columns * bundle.rows);
    const LineReading in_box = lines_in_both(lines_in_box(box), reading);
    tbb::parallel_for(std::size_t{0}, reached.size(), [&](std::size_t i) {
      if (options.progress.stop.stop_requested()) return;
      for (const Span& span : in_box.inside(bundle.line(i), {{0.0, bundle.reach_mm}})) {
        reached[i].length_mm += span.high_mm - span.low_mm;
        reached[i].crossings += 2;
      }
    });
    options.progress.at(static_cast<double>(number + 1) / directions);
    const double cell_mm2 = bundle.cell_mm * bundle.cell_mm;
    std::uint64_t crossings = 0;
    for (const Reached& line : reached) {
      volumes_mm3[number] += line.length_mm * cell_mm2;
      crossings += line.crossings;
    }
    areas_mm2 += 2.0 * static_cast<double>(crossings) * cell_mm2;
    count.crossings += crossings;
    count.lines += reached.size();
    count.volume_mm3 += volumes_mm3[number++] / directions;
  }
  count.area_mm2 = areas_mm2 / directions;
  double squares = 0.0;
  for (const double volume_mm3 : volumes_mm3) squares += std::pow(volume_mm3 - count.volume_mm3, 2.0);
  count.deviation_mm3 = std::sqrt(squares / (directions * (directions - 1.0)));
  return count;
}

}  // namespace octotomy::verify
