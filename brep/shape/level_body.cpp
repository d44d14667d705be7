// SPDX-License-Identifier: AGPL-3.0-or-later
// The depth of a point within an intersection is exactly the least of its depths within the operands. The
// largest depth within the parts of a union is at most the depth within the union, so only balls that fit
// into one part count. Both depths change by at most the distance between points. Distances are computed only
// where they decide: a level is skipped if its box is far, or if its depth can no longer be the least or the
// largest. Where points are dense, distances at the middles of coarse cells bound those at the points, so
// that most levels are skipped without changing a value. Values of points that lie farther than `far_mm`
// outside may be too small, because no surface is near them.
#include "brep/shape/level_body.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unordered_map>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"
#include "brep/mesh/measure.h"
#include "brep/shape/level_surface.h"

namespace octotomy::brep {
namespace {

/// Edge of the coarse cells in cells of the options. The distance at a coarse cell's middle bounds the
/// distances at all points of the cell.
constexpr double coarse_cells = 1.5;
constexpr double infinite = std::numeric_limits<double>::infinity();

double to_box_mm(const Size& box, const glm::dvec3& p_mm) {
  return glm::length(glm::max(glm::max(box.low_mm - p_mm, p_mm - box.high_mm), 0.0));
}

/// The levels of a body: the subtracted ones, then those of each part.
std::vector<const Level*> levels_of(const LevelBody& body) {
  std::vector<const Level*> levels;
  for (const Level& level : body.without) levels.push_back(&level);
  for (const std::vector<Level>& part : body.parts)
    for (const Level& level : part) levels.push_back(&level);
  return levels;
}

/// Lower and upper bounds of the distances of points to all levels, by level and point.
struct Bounds {
  std::vector<std::vector<double>> least_mm, most_mm;
};

/// Distances at the middles of cells. They bound the distances at all points in a cell, because distances
/// change by at most the distance between points. The distances of a cell are computed only after
/// `enough_points` points have lain in it.
class CoarseDistances {
 public:
  CoarseDistances(const LevelBody& body, double edge_mm)
      : levels_(levels_of(body)), edge_mm_(edge_mm), at_middle_mm_(levels_.size()) {}

  Bounds bounds(const std::vector<glm::dvec3>& points_mm) {
    const std::vector<std::uint32_t> cells = cells_of(points_mm);
    Bounds made{std::vector<std::vector<double>>(levels_.size(), std::vector<double>(points_mm.size())), {}};
    made.most_mm = made.least_mm;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points_mm.size(), 1024), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const bool is_known = cells[i] != none;
        // The margin is far above the rounding of distances.
        const double off_mm =
            is_known ? glm::distance(points_mm[i], middles_mm_[cells[i]]) + 1e-6 * edge_mm_ : 0.0;
        for (std::size_t n = 0; n < levels_.size(); ++n) {
          const double box_mm = to_box_mm(levels_[n]->solid.size(), points_mm[i]);
          double least_mm = box_mm > 0.0 ? box_mm - levels_[n]->by_mm : -infinite, most_mm = infinite;
          if (is_known) {
            least_mm = std::max(least_mm, at_middle_mm_[n][cells[i]] - off_mm);
            most_mm = at_middle_mm_[n][cells[i]] + off_mm;
          }
          made.least_mm[n][i] = least_mm;
          made.most_mm[n][i] = most_mm;
        }
      }
    });
    return made;
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  static constexpr std::uint32_t enough_points = 6;

  std::uint64_t key_of(const glm::dvec3& p_mm) const {
    // 21 bits an axis: lattices have at most 2^17 cells.
    const glm::i64vec3 cell(glm::floor(p_mm / edge_mm_));
    constexpr std::uint64_t bits = (std::uint64_t{1} << 21) - 1;
    return (static_cast<std::uint64_t>(cell.x) & bits) | (static_cast<std::uint64_t>(cell.y) & bits) << 21 |
           (static_cast<std::uint64_t>(cell.z) & bits) << 42;
  }

  /// The number of each point's cell, or none.
  std::vector<std::uint32_t> cells_of(const std::vector<glm::dvec3>& points_mm) {
    std::vector<std::uint64_t> keys(points_mm.size());
    tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t i) { keys[i] = key_of(points_mm[i]); });
    std::vector<glm::dvec3> added_mm;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      Cell& cell = cells_[keys[i]];
      if (cell.number != none || ++cell.points < enough_points) continue;
      cell.number = static_cast<std::uint32_t>(middles_mm_.size());
      middles_mm_.push_back((glm::floor(points_mm[i] / edge_mm_) + 0.5) * edge_mm_);
      added_mm.push_back(middles_mm_.back());
    }
    for (std::size_t n = 0; n < levels_.size(); ++n) {
      std::vector<std::uint32_t> nearest(added_mm.size(), SurfaceTree::unknown_triangle);
      for (const double mm : levels_[n]->solid.tree().signed_distances_mm(added_mm, nearest))
        at_middle_mm_[n].push_back(mm - levels_[n]->by_mm);
    }
    std::vector<std::uint32_t> numbers(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) numbers[i] = cells_.find(keys[i])->second.number;
    return numbers;
  }

  struct Cell {
    std::uint32_t number = none, points = 0;
  };

  std::vector<const Level*> levels_;
  double edge_mm_;
  std::unordered_map<std::uint64_t, Cell> cells_;
  std::vector<glm::dvec3> middles_mm_;
  std::vector<std::vector<double>> at_middle_mm_;  ///< distances at the cells' middles, by level and cell
};

/// Calls `take(i, distance)` with the signed distance to a level of each point for which `needs(i)` is true.
template <typename Needs, typename Take>
void for_distances(const Level& level, const std::vector<glm::dvec3>& points_mm, const Needs& needs,
                   const Take& take) {
  std::vector<std::size_t> asked;
  std::vector<glm::dvec3> asked_mm;
  for (std::size_t i = 0; i < points_mm.size(); ++i)
    if (needs(i)) {
      asked.push_back(i);
      asked_mm.push_back(points_mm[i]);
    }
  std::vector<std::uint32_t> nearest(asked.size(), SurfaceTree::unknown_triangle);
  const std::vector<double> found_mm = level.solid.tree().signed_distances_mm(asked_mm, nearest);
  for (std::size_t k = 0; k < asked.size(); ++k) take(asked[k], found_mm[k] - level.by_mm);
}

/// Signed distances to the body, negative inside: exact near the surface, see above.
std::vector<double> values_of(const LevelBody& body, CoarseDistances& coarse,
                              const std::vector<glm::dvec3>& points_mm, double far_mm) {
  const std::size_t count = points_mm.size();
  const Bounds bounds = coarse.bounds(points_mm);
  // Bounds of a point's value, by the subtracted levels and by the parts.
  std::vector<double> least_without(count, -infinite), least_united(count, infinite),
      most_united(count, infinite), part(count), most(count);
  for (std::size_t n = 0; n < body.without.size(); ++n)
    for (std::size_t i = 0; i < count; ++i)
      least_without[i] = std::max(least_without[i], -bounds.most_mm[n][i]);
  std::size_t first = body.without.size();
  for (const std::vector<Level>& levels : body.parts) {
    for (std::size_t i = 0; i < count; ++i) {
      double least_part = -infinite, most_part = -infinite;
      for (std::size_t n = first; n < first + levels.size(); ++n) {
        least_part = std::max(least_part, bounds.least_mm[n][i]);
        most_part = std::max(most_part, bounds.most_mm[n][i]);
      }
      least_united[i] = std::min(least_united[i], least_part);
      most_united[i] = std::min(most_united[i], most_part);
    }
    first += levels.size();
  }
  std::vector<double> value(count, -infinite);
  // Points that are surely far outside need no distance.
  for (std::size_t i = 0; i < count; ++i)
    if (const double least = std::max(least_without[i], least_united[i]);
        least >= far_mm && least < infinite && bounds.most_mm[0][i] < infinite)
      value[i] = least;
  for (std::size_t n = 0; n < body.without.size(); ++n)
    for_distances(
        body.without[n], points_mm,
        [&](std::size_t i) {
          return value[i] < far_mm && -bounds.least_mm[n][i] > value[i] &&
                 -bounds.least_mm[n][i] > least_without[i] && -bounds.least_mm[n][i] > least_united[i];
        },
        [&](std::size_t i, double mm) { value[i] = std::max(value[i], -mm); });
  std::vector<double> united(count, infinite);
  first = body.without.size();
  for (const std::vector<Level>& levels : body.parts) {
    for (std::size_t i = 0; i < count; ++i) {
      part[i] = -infinite;
      for (std::size_t n = first; n < first + levels.size(); ++n)
        part[i] = std::max(part[i], bounds.least_mm[n][i]);
    }
    // A part's distance is not needed if another part is nearer, or if the subtracted levels already decide
    // the point's value.
    for (std::size_t k = 0; k < levels.size(); ++k)
      for_distances(
          levels[k], points_mm,
          [&](std::size_t i) {
            return value[i] < far_mm && united[i] > value[i] && part[i] < united[i] &&
                   part[i] < most_united[i] && bounds.most_mm[first + k][i] > part[i] &&
                   most_united[i] > value[i];
          },
          [&](std::size_t i, double mm) { part[i] = std::max(part[i], mm); });
    for (std::size_t i = 0; i < count; ++i) united[i] = std::min(united[i], part[i]);
    first += levels.size();
  }
  for (std::size_t i = 0; i < count; ++i)
    if (value[i] < far_mm) value[i] = std::max(value[i], united[i]);
  return value;
}

/// A box that holds the body.
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
  if (body.parts.empty()) throw InvalidInput("a body of levels needs at least one part");
  const auto check_level = [](const Level& level) {
    if (level.solid.empty()) throw InvalidInput("a level needs a solid that is not empty");
    if (!std::isfinite(level.by_mm)) throw InvalidInput("a level must be moved by a finite length");
  };
  for (const std::vector<Level>& levels : body.parts) {
    if (levels.empty()) throw InvalidInput("a part of a body of levels needs at least one level");
    std::for_each(levels.begin(), levels.end(), check_level);
  }
  std::for_each(body.without.begin(), body.without.end(), check_level);
}

}  // namespace

Solid core_of(const LevelBody& body, const OffsetOptions& options) {
  check(body);
  if (!std::isfinite(options.by_mm) || options.by_mm > 0.0)
    throw InvalidInput("the depth of a core must be 0 mm or more");
  if (!std::isfinite(options.cell_mm) || options.cell_mm <= 0.0)
    throw InvalidInput("the edge of an offset's cells must be above 0 mm");
  const Size size = size_of(body);
  if (!glm::all(glm::lessThan(size.low_mm, size.high_mm))) return Solid();
  const double far_mm = 4.0 * options.cell_mm;
  CoarseDistances coarse(body, coarse_cells * options.cell_mm);
  const LevelField field = [&](const std::vector<glm::dvec3>& points_mm, std::vector<std::uint32_t>&) {
    std::vector<double> values = values_of(body, coarse, points_mm, far_mm);
    for (double& value : values) value -= options.by_mm;
    return values;
  };
  return level_surface(field, size, options);
}

double volume_beyond_mm3(const LevelBody& body, const Solid& solid, double beyond_mm, double step_mm) {
  check(body);
  const Size size = size_of(body);
  if (!glm::all(glm::lessThan(size.low_mm, size.high_mm))) return 0.0;
  // Divides the cubes that may hold points of the body far enough outside the solid.
  constexpr int halvings = 3;
  double edge_mm = step_mm * (1 << halvings);
  std::vector<glm::dvec3> middles_mm;
  const glm::ivec3 cubes(glm::ceil((size.high_mm - size.low_mm) / edge_mm));
  for (int z = 0; z < cubes.z; ++z)
    for (int y = 0; y < cubes.y; ++y)
      for (int x = 0; x < cubes.x; ++x)
        middles_mm.push_back(size.low_mm + edge_mm * (glm::dvec3(x, y, z) + 0.5));
  CoarseDistances coarse(body, 2.0 * edge_mm);
  for (int level = 0;; ++level) {
    const double reach_mm = 0.5 * std::sqrt(3.0) * edge_mm;
    const std::vector<double> values = values_of(body, coarse, middles_mm, 2.0 * edge_mm);
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
