// SPDX-License-Identifier: AGPL-3.0-or-later
// The depth of a point within an intersection is the least of its depths within the operands, and that is exact.
// The largest depth within the parts of a union is at most the depth within the union, so that balls count that fit
// into one part. Both change no faster than places do.
//
// Distances are computed where they count: a level whose box is far, or that cannot be the least or largest
// any more, is passed over. Values of points that lie deeper than `far_mm` in what is taken away are left as they
// are: no surface is near them.
#include "brep/shape/level_body.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/shape/level_surface.h"

namespace octotomy::brep {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double to_box_mm(const Size& box, const glm::dvec3& p_mm) {
  return glm::length(glm::max(glm::max(box.low_mm - p_mm, p_mm - box.high_mm), 0.0));
}

/// Signed distances to levels, negative inside. They are computed only for requested points.
class LevelDistances {
 public:
  explicit LevelDistances(const std::vector<glm::dvec3>& points_mm) : points_mm_(points_mm) {}

  /// A lower bound on a point's distance.
  double least_mm(const Level& level, std::size_t i) const {
    const double box_mm = to_box_mm(level.solid.size(), points_mm_[i]);
    return box_mm > 0.0 ? box_mm - level.by_mm : -infinite;
  }
  /// Calls `take(i, distance)` for each point for which `needs(i)` is true.
  template <typename Needs, typename Take>
  void of(const Level& level, const Needs& needs, const Take& take) {
    asked_.clear();
    asked_mm_.clear();
    for (std::size_t i = 0; i < points_mm_.size(); ++i)
      if (needs(i)) {
        asked_.push_back(i);
        asked_mm_.push_back(points_mm_[i]);
      }
    std::vector<std::uint32_t> nearest(asked_.size(), SurfaceTree::unknown_triangle);
    const std::vector<double> found_mm = level.solid.tree().signed_distances_mm(asked_mm_, nearest);
    for (std::size_t k = 0; k < asked_.size(); ++k) take(asked_[k], found_mm[k] - level.by_mm);
  }

 private:
  const std::vector<glm::dvec3>& points_mm_;
  std::vector<std::size_t> asked_;
  std::vector<glm::dvec3> asked_mm_;
};

/// Signed distances to the body, negative inside. They are exact where the result depends on them, see above.
std::vector<double> values_of(const LevelBody& body, const std::vector<glm::dvec3>& points_mm,
                              double far_mm) {
  LevelDistances distances(points_mm);
  const std::size_t count = points_mm.size();
  std::vector<double> value(count, -infinite);
  for (const Level& level : body.without)
    distances.of(
        level, [&](std::size_t i) { return value[i] < far_mm && -distances.least_mm(level, i) > value[i]; },
        [&](std::size_t i, double mm) { value[i] = std::max(value[i], -mm); });
  std::vector<double> united(count, infinite), part(count);
  for (const std::vector<Level>& levels : body.parts) {
    for (std::size_t i = 0; i < count; ++i) {
      part[i] = -infinite;
      for (const Level& level : levels) part[i] = std::max(part[i], distances.least_mm(level, i));
    }
    // Skips parts that cannot change a point's result: parts farther off than another part, and parts in
    // which the point lies less far outside than it lies inside `without`.
    for (const Level& level : levels)
      distances.of(
          level,
          [&](std::size_t i) { return value[i] < far_mm && united[i] > value[i] && part[i] < united[i]; },
          [&](std::size_t i, double mm) { part[i] = std::max(part[i], mm); });
    for (std::size_t i = 0; i < count; ++i) united[i] = std::min(united[i], part[i]);
  }
  for (std::size_t i = 0; i < count; ++i)
    if (value[i] < far_mm) value[i] = std::max(value[i], united[i]);
  return value;
}

/// A box that contains the body.
Size size_of(const LevelBody& body) {
  Size all{.low_mm = glm::dvec3(infinite), .high_mm = glm::dvec3(-infinite)};
  for (const std::vector<Level>& levels : body.parts) {
    glm::dvec3 low(-infinite), high(infinite);
    for (const Level& level : levels) {
      low = glm::max(low, level.solid.size().low_mm - level.by_mm);
      high = glm::min(high, level.solid.size().high_mm + level.by_mm);
    }
    if (glm::any(glm::greaterThan(low, high))) continue;
    all.low_mm = glm::min(all.low_mm, low);
    all.high_mm = glm::max(all.high_mm, high);
  }
  return all;
}

void check(const LevelBody& body) {
  if (body.parts.empty()) throw InvalidInput("a body of levels has at least one part");
  const auto check_level = [](const Level& level) {
    if (level.solid.empty()) throw InvalidInput("a level is that of a solid that is not empty");
    if (!std::isfinite(level.by_mm)) throw InvalidInput("a level is moved by a finite length");
  };
  for (const std::vector<Level>& levels : body.parts) {
    if (levels.empty()) throw InvalidInput("a part of a body of levels has at least one level");
    std::for_each(levels.begin(), levels.end(), check_level);
  }
  std::for_each(body.without.begin(), body.without.end(), check_level);
}

}  // namespace

Solid core_of(const LevelBody& body, const OffsetOptions& options) {
  check(body);
  if (!std::isfinite(options.by_mm) || options.by_mm > 0.0)
    throw InvalidInput("the core of a body of levels lies at a depth of 0 mm or more");
  if (!std::isfinite(options.cell_mm) || options.cell_mm <= 0.0)
    throw InvalidInput("an offset's cells have an edge above 0 mm");
  const Size size = size_of(body);
  if (!glm::all(glm::lessThan(size.low_mm, size.high_mm))) return Solid();
  const double far_mm = 4.0 * options.cell_mm;
  const LevelField field = [&](const std::vector<glm::dvec3>& points_mm, std::vector<std::uint32_t>&) {
    std::vector<double> values = values_of(body, points_mm, far_mm);
    for (double& value : values) value -= options.by_mm;
    return values;
  };
  return level_surface(field, size, options);
}

double volume_beyond_mm3(const LevelBody& body, const Solid& solid, double beyond_mm, double step_mm) {
  check(body);
  const Size size = size_of(body);
  if (!glm::all(glm::lessThan(size.low_mm, size.high_mm))) return 0.0;
  // Cubes are divided while they may contain points of the body that are far enough outside the solid.
  constexpr int halvings = 3;
  double edge_mm = step_mm * (1 << halvings);
  std::vector<glm::dvec3> middles_mm;
  const glm::ivec3 cubes(glm::ceil((size.high_mm - size.low_mm) / edge_mm));
  for (int z = 0; z < cubes.z; ++z)
    for (int y = 0; y < cubes.y; ++y)
      for (int x = 0; x < cubes.x; ++x)
        middles_mm.push_back(size.low_mm + edge_mm * (glm::dvec3(x, y, z) + 0.5));
  for (int level = 0;; ++level) {
    const double reach_mm = 0.5 * std::sqrt(3.0) * edge_mm;
    const std::vector<double> values = values_of(body, middles_mm, 2.0 * edge_mm);
    std::vector<glm::dvec3> kept_mm;
    for (std::size_t i = 0; i < middles_mm.size(); ++i)
      if (values[i] < (level < halvings ? reach_mm : 0.0)) kept_mm.push_back(middles_mm[i]);
    std::vector<double> off_mm(kept_mm.size(), infinite);
    if (!solid.empty()) {
      std::vector<std::uint32_t> nearest(kept_mm.size(), SurfaceTree::unknown_triangle);
      off_mm = solid.tree().signed_distances_mm(kept_mm, nearest);
    }
    std::size_t count = 0;
    std::vector<glm::dvec3> smaller_mm;
    for (std::size_t i = 0; i < kept_mm.size(); ++i) {
      if (!(off_mm[i] > beyond_mm - (level < halvings ? reach_mm : 0.0))) continue;
      ++count;
      for (int child = 0; child < 8 && level < halvings; ++child)
        smaller_mm.push_back(kept_mm[i] +
                             0.5 * edge_mm * (glm::dvec3(child & 1, (child >> 1) & 1, child >> 2) - 0.5));
    }
    if (level == halvings) return static_cast<double>(count) * edge_mm * edge_mm * edge_mm;
    middles_mm = std::move(smaller_mm);
    edge_mm *= 0.5;
  }
}

}  // namespace octotomy::brep
