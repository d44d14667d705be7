// Repeated polygons: 1 measure every polygon; 2 sort them by a number that differs between equal lines by no
// more than the rounding allows; 3 compare points with edges for polygons with nearby numbers.
// Crossing polygons: 1 find edges that touch, by boxes; 2 for two polygons that touch, check whether each lies on
// both sides of the other by more than the rounding, at its corners and between its touches; 3 where a polygon
// crosses itself, check by areas whether the two loops overlap or lie side by side.
#include "voxel/solid/polygon_overlaps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>

#include "voxel/solid/edge_tree.h"
#include "voxel/solid/polygon.h"
#include "voxel/solid/region_mask.h"

namespace octotomy::voxel {
namespace {

using Polygon = std::vector<glm::dvec2>;

struct Measures {
  glm::dvec2 low{std::numeric_limits<double>::infinity()}, high{-low};
  double area_mm2 = 0.0;
  double perimeter_mm = 0.0;

  double size_mm() const { return glm::length(high - low); }
};

Measures measures_of(const Polygon& polygon) {
  Measures measures;
  if (polygon.empty()) return measures;
  measures.area_mm2 = std::abs(signed_area(polygon));
  for (std::size_t i = 0, last = polygon.size() - 1; i < polygon.size(); last = i++) {
    measures.low = glm::min(measures.low, polygon[i]);
    measures.high = glm::max(measures.high, polygon[i]);
    measures.perimeter_mm += glm::length(polygon[i] - polygon[last]);
  }
  return measures;
}

/// The tolerance for a polygon: `rounding_mm`, but at most a thousandth of the polygon's size.
double rounding_of(const Measures& measures, double rounding_mm) {
  return std::min(rounding_mm, 1e-3 * measures.size_mm());
}

bool within(const glm::dvec2& a, const glm::dvec2& b, double distance) {
  return glm::all(glm::lessThanEqual(glm::abs(a - b), glm::dvec2(distance)));
}

bool lies_along(const Polygon& polygon, const EdgeTree& edges, double distance_mm) {
  return std::all_of(polygon.begin(), polygon.end(),
                     [&](const glm::dvec2& p) { return edges.square_to(p) <= distance_mm * distance_mm; });
}

/// The edge trees of the polygons, each built at its first use.
class Trees {
 public:
  explicit Trees(const std::vector<Polygon>& polygons) : polygons_(polygons), trees_(polygons.size()) {}

  const EdgeTree& operator[](std::size_t number) {
    if (!trees_[number]) trees_[number] = std::make_unique<EdgeTree>(std::vector<Polygon>{polygons_[number]});
    return *trees_[number];
  }

 private:
  const std::vector<Polygon>& polygons_;
  std::vector<std::unique_ptr<EdgeTree>> trees_;
};

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// The point at which two edges cross in the interior of both; none if they only touch.
std::optional<glm::dvec2> crossing_of(const Edge& a, const Edge& b) {
  const double from = turn(a[0], a[1], b[0]), to = turn(a[0], a[1], b[1]);
  if (!((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0))) return std::nullopt;
  if ((turn(b[0], b[1], a[0]) < 0.0) == (turn(b[0], b[1], a[1]) < 0.0)) return std::nullopt;
  return b[0] + from / (from - to) * (b[1] - b[0]);
}

/// Whether the distance between two edges is at most a limit.
bool touch(const Edge& a, const Edge& b, double distance_mm) {
  const double square = distance_mm * distance_mm;
  return square_to_segment(a[0], b[0], b[1]) <= square || square_to_segment(a[1], b[0], b[1]) <= square ||
         square_to_segment(b[0], a[0], a[1]) <= square || square_to_segment(b[1], a[0], a[1]) <= square ||
         crossing_of(a, b);
}

class Crossings {
 public:
  Crossings(const std::vector<Polygon>& polygons, double rounding_mm)
      : polygons_(polygons),
        rounding_mm_(rounding_mm),
        all_(polygons),
        trees_(polygons),
        at_(polygons.size()),
        asked_(polygons.size(), polygons.size()) {
    for (const Polygon& polygon : polygons) {
      measures_.push_back(measures_of(polygon));
      // Edges are numbered as in EdgeTree, where a polygon of n points uses n + 1 numbers.
      first_.push_back(edge_count_);
      if (!polygon.empty()) edge_count_ += polygon.size() + 1;
    }
    pairs_left_ = 64 * edge_count_ + 1'000'000;
  }

  CrossingPolygons run() {
    for (std::size_t i = 0; i < polygons_.size(); ++i) ask(i);
    CrossingPolygons found;
    for (std::size_t i = 0; i < at_.size(); ++i)
      if (at_[i]) found.all.push_back({i, *at_[i]});
    found.is_complete = pairs_left_ > 0;
    return found;
  }

 private:
  /// The edge of polygon `number` that ends in point `i`.
  Edge edge(std::size_t number, std::size_t i) const {
    const Polygon& polygon = polygons_[number];
    return {polygon[i == 0 ? polygon.size() - 1 : i - 1], polygon[i]};
  }

  void ask(std::size_t number) {
    const Polygon& polygon = polygons_[number];
    const double margin_mm = rounding_of(measures_[number], rounding_mm_);
    begin_sums(polygon);
    for (std::size_t i = 0; i < polygon.size() && pairs_left_ > 0 && !at_[number]; ++i) {
      const Edge one = edge(number, i);
      const glm::dvec2 low = glm::min(one[0], one[1]) - margin_mm,
                       high = glm::max(one[0], one[1]) + margin_mm;
      all_.visit(low, high, [&](const glm::dvec2& from, const glm::dvec2& to, std::size_t other_edge) {
        if (pairs_left_ == 0 || at_[number]) return;
        --pairs_left_;
        if (glm::any(glm::lessThan(glm::max(from, to), low)) ||
            glm::any(glm::greaterThan(glm::min(from, to), high)))
          return;
        const auto after = std::upper_bound(first_.begin(), first_.end(), other_edge);
        const auto other = static_cast<std::size_t>(after - first_.begin()) - 1;
        if (other == number)
          ask_itself(number, i, other_edge - first_[number]);
        else if (!is_asked(number, other) && touch(one, {from, to}, margin_mm))
          ask_pair(number, other, one);
      });
    }
  }

  /// Whether two polygons were compared already. A polygon that was examined earlier and has no crossings was
  /// compared with all polygons that it touches.
  bool is_asked(std::size_t number, std::size_t other) const {
    return asked_[other] == number || (other < number && !at_[other]);
  }

  void ask_pair(std::size_t number, std::size_t other, const Edge& touching) {
    asked_[other] = number;
    // The polygon with fewer points is tested first, because this decides most pairs that only touch.
    const auto [few, many] = polygons_[number].size() < polygons_[other].size() ? std::pair(number, other)
                                                                                : std::pair(other, number);
    if (!is_on_both_sides(few, many) || !is_on_both_sides(many, few)) return;
    for (const std::size_t each : {number, other})
      if (!at_[each]) at_[each] = 0.5 * (touching[0] + touching[1]);
  }

  bool is_on_both_sides(std::size_t number, std::size_t other) {
    const EdgeTree& edges = trees_[other];
    const Measures &one = measures_[number], &two = measures_[other];
    const double margin_mm = std::min(rounding_of(one, rounding_mm_), rounding_of(two, rounding_mm_));
    // Edges outside the box around the other polygon lie outside that polygon.
    const glm::dvec2 low = two.low - margin_mm, high = two.high + margin_mm;
    bool is_inside = false;
    bool is_outside = glm::any(glm::lessThan(one.low, low)) || glm::any(glm::greaterThan(one.high, high));
    const auto see = [&](const glm::dvec2& p) {
      // The distance is computed only if no earlier point lies on the same side of the other polygon.
      bool& known = edges.contains(p) ? is_inside : is_outside;
      if (!known) known = edges.square_to(p) > margin_mm * margin_mm;
    };
    std::vector<double> parts;
    trees_[number].visit(low, high, [&](const glm::dvec2& from, const glm::dvec2& to, std::size_t) {
      if (is_inside && is_outside) return;
      see(to);
      part_at_touches({from, to}, edges, margin_mm, parts);
      for (std::size_t k = 1; k < parts.size(); ++k)
        if (parts[k] > parts[k - 1]) see(from + 0.5 * (parts[k - 1] + parts[k]) * (to - from));
    });
    return is_inside && is_outside;
  }

  /// Positions along an edge, from 0 to 1 and ascending, at which other edges may meet it; 0 and 1 included.
  /// Empty if the edge is shorter than the rounding.
  void part_at_touches(const Edge& one, const EdgeTree& others, double margin_mm,
                       std::vector<double>& parts) {
    parts.clear();
    const glm::dvec2 along = one[1] - one[0];
    const double square = glm::dot(along, along);
    if (!(square > margin_mm * margin_mm)) return;
    parts = {0.0, 1.0};
    const auto add = [&](const glm::dvec2& p) {
      parts.push_back(std::clamp(glm::dot(p - one[0], along) / square, 0.0, 1.0));
    };
    others.visit(glm::min(one[0], one[1]), glm::max(one[0], one[1]),
                 [&](const glm::dvec2& from, const glm::dvec2& to, std::size_t) {
                   if (pairs_left_ == 0) return;
                   --pairs_left_;
                   add(from);
                   add(to);
                   if (const auto met = crossing_of(one, {from, to})) add(*met);
                 });
    std::sort(parts.begin(), parts.end());
  }

  /// Cumulative areas and lengths along the polygon, from which the area and length of any loop are computed
  /// in constant time.
  void begin_sums(const Polygon& polygon) {
    twice_areas_.assign(1, 0.0);
    lengths_.assign(1, 0.0);
    for (std::size_t i = 1; i < polygon.size(); ++i) {
      const glm::dvec2 a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
      twice_areas_.push_back(twice_areas_.back() + a.x * b.y - a.y * b.x);
      lengths_.push_back(lengths_.back() + glm::length(b - a));
    }
    loops_walked_ = 0;
  }

  void ask_itself(std::size_t number, std::size_t a, std::size_t b) {
    if (a >= b) return;  // each pair once
    const Polygon& polygon = polygons_[number];
    const auto met = crossing_of(edge(number, a), edge(number, b));
    if (!met) return;
    // The crossing splits the polygon into the loop through points a .. b - 1 and the rest.
    const glm::dvec2 x = *met - polygon[0], first = polygon[a] - polygon[0],
                     last = polygon[b - 1] - polygon[0];
    const double twice_loop = twice_areas_[b - 1] - twice_areas_[a] + (x.x * first.y - x.y * first.x) +
                              (last.x * x.y - last.y * x.x);
    const double twice_rest = twice_areas_.back() - twice_loop;
    const double loop_mm = lengths_[b - 1] - lengths_[a] + glm::length(first - x) + glm::length(x - last);
    const double rest_mm = measures_[number].perimeter_mm - loop_mm;
    const double margin_mm = rounding_of(measures_[number], rounding_mm_);
    // A loop within a strip as wide as the rounding encloses at most length times width.
    if (!(std::abs(twice_loop) > margin_mm * loop_mm && std::abs(twice_rest) > margin_mm * rest_mm)) return;
    if ((twice_loop > 0.0) == (twice_rest > 0.0) || is_side_by_side(polygon, a, b, *met)) at_[number] = *met;
  }

  /// Whether two loops of opposite directions lie outside each other, unlike a keyhole and its hole. Each
  /// call costs a pass over the polygon, so after `most_walked` calls all such loops count as holes.
  bool is_side_by_side(const Polygon& polygon, std::size_t a, std::size_t b, const glm::dvec2& met) {
    constexpr int most_walked = 16;
    if (++loops_walked_ > most_walked) return false;
    const auto at = [&](std::size_t i) { return polygon.begin() + static_cast<std::ptrdiff_t>(i); };
    Polygon loop{met}, rest{met};
    loop.insert(loop.end(), at(a), at(b));
    rest.insert(rest.end(), at(b), polygon.end());
    rest.insert(rest.end(), polygon.begin(), at(a));
    const auto farthest = [&](const Polygon& of) {
      return *std::max_element(of.begin(), of.end(), [&](const glm::dvec2& p, const glm::dvec2& q) {
        return glm::length(p - met) < glm::length(q - met);
      });
    };
    return !contains({rest}, farthest(loop)) && !contains({loop}, farthest(rest));
  }

  const std::vector<Polygon>& polygons_;
  const double rounding_mm_;
  EdgeTree all_;
  Trees trees_;
  std::vector<Measures> measures_;
  std::vector<std::size_t> first_;  ///< number of each polygon's first edge
  std::size_t edge_count_ = 0, pairs_left_ = 0;
  /// For each polygon with a crossing, a point near the crossing.
  std::vector<std::optional<glm::dvec2>> at_;
  /// For each polygon, the number of the last one compared with it.
  std::vector<std::size_t> asked_;
  std::vector<double> twice_areas_, lengths_;
  int loops_walked_ = 0;
};

}  // namespace

std::vector<std::size_t> repeated_polygons(const std::vector<Polygon>& polygons_mm, double rounding_mm) {
  if (polygons_mm.size() < 2) return {};
  std::vector<std::size_t> repeated;
  std::vector<Measures> measures;
  Trees trees(polygons_mm);
  // The weights are incommensurable, so that different bounds rarely have equal sums.
  const auto sum_of = [](const Measures& of) {
    return of.low.x + 1.2720196 * of.low.y + 1.4142136 * of.high.x + 1.6180340 * of.high.y;
  };
  constexpr double weights = 5.31;
  std::multimap<double, std::size_t> kept;
  for (std::size_t i = 0; i < polygons_mm.size(); ++i) {
    measures.push_back(measures_of(polygons_mm[i]));
    if (polygons_mm[i].empty()) continue;
    const Measures& of = measures.back();
    const double off_mm = rounding_of(of, rounding_mm);
    const double sum = sum_of(of);
    // If a line moves by the rounding, the area changes by at most that of a strip along the line.
    const auto is_same = [&](const auto& near) {
      const Measures& other = measures[near.second];
      return within(of.low, other.low, off_mm) && within(of.high, other.high, off_mm) &&
             std::abs(of.area_mm2 - other.area_mm2) <=
                 off_mm * std::max(of.perimeter_mm, other.perimeter_mm) &&
             lies_along(polygons_mm[i], trees[near.second], off_mm) &&
             lies_along(polygons_mm[near.second], trees[i], off_mm);
    };
    if (std::any_of(kept.lower_bound(sum - weights * off_mm), kept.upper_bound(sum + weights * off_mm),
                    is_same))
      repeated.push_back(i);
    else
      kept.emplace(sum, i);
  }
  return repeated;
}

CrossingPolygons crossing_polygons(const std::vector<Polygon>& polygons_mm, double rounding_mm) {
  return Crossings(polygons_mm, rounding_mm).run();
}

}  // namespace octotomy::voxel
