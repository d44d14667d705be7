// SPDX-License-Identifier: AGPL-3.0-or-later
// A strip is a path in a graph: node (i, j) is the span from the lower ring's point i to the upper ring's
// point j, and a step to (i + 1, j) or (i, j + 1) is a triangle. If costs depend on single triangles: every
// strip has a span at the lower ring's first point. Therefore 1 find the path of least cost from (0, 0) to
// (m, n); from (0, n) to (m, 2n) it is the same; 2 find the path that starts half way between two known ones,
// which it need not cross, and so on; 3 write the triangles of the best. Otherwise: 1 find the start; 2 walk
// greedily, or find the path of least cost from there. Where spans are to be clear of contours, each span that is
// not costs more than any strip without it.
#include "brep/contour/tile.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

enum Step : std::uint8_t { along_lower, along_upper };

struct Triangle {
  glm::dvec3 a, b, c;
  glm::dvec3 normal() const { return glm::cross(b - a, c - a); }
};

/// The rings, rotated so that both starts are their first points.
struct Pair {
  std::vector<glm::dvec3> lower, upper;  ///< the first point is repeated at the end

  /// The triangle of a step from a span.
  Triangle triangle(std::size_t i, std::size_t j, Step step) const {
    assert(i + (step == along_lower) <= m() && j + (step == along_upper) <= n());
    return step == along_lower ? Triangle{lower[i], lower[i + 1], upper[j]}
                               : Triangle{upper[j + 1], upper[j], lower[i]};
  }
  std::size_t m() const { return lower.size() - 1; }
  std::size_t n() const { return upper.size() - 1; }
};

/// The points moved and scaled so that their box is the unit square.
std::vector<glm::dvec2> in_unit_square(const std::vector<glm::dvec2>& points) {
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const glm::dvec2& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec2 extent = glm::max(high - low, glm::dvec2(std::numeric_limits<double>::min()));
  std::vector<glm::dvec2> scaled;
  scaled.reserve(points.size());
  for (const glm::dvec2& p : points) scaled.push_back((p - low) / extent);
  return scaled;
}

/// Scores the spans between two rings; lower is better. 0: the span lies over the area of exactly one ring
/// and crosses no side. 1: it lies over both areas or neither, as where the rings cross. Otherwise more for
/// each side that it crosses.
class Blame {
 public:
  Blame(const Ring& lower, const Ring& upper, const SpanClearance& sides,
        const std::vector<std::array<std::uint32_t, 3>>& avoided)
      : m_(lower.points_mm.size()), n_(upper.points_mm.size()), of_(m_ * n_) {
    constexpr int most_sides = 6;
    const double reach_mm = reach_of(lower, upper);
    for (std::size_t i = 0; i < m_; ++i)
      for (std::size_t j = 0; j < n_; ++j) {
        const glm::dvec2 &a = lower.points_mm[i], &b = upper.points_mm[j];
        const int crossed = glm::distance(a, b) > reach_mm ? most_sides : sides.crossed(a, b, most_sides);
        const bool is_beside = starts_inside(lower, i, b) != starts_inside(upper, j, a);
        of_[i * n_ + j] = static_cast<std::uint8_t>(crossed > 0 ? 1 + crossed : is_beside ? 0 : 1);
      }
    if (avoided.empty()) return;
    for (std::vector<int>& of_step : of_step_) of_step.assign(m_ * n_, 0);
    for (const auto& face : avoided) {
      const Step step = face[2] < m_ ? along_upper : along_lower;
      const std::size_t i = step == along_lower ? face[0] : face[2];
      const std::size_t j = (step == along_lower ? face[2] : face[1]) - m_;
      ++of_step_[step][i * n_ + j];
    }
  }

  /// The score of the span between two points; numbers beyond the rings' ends continue at their starts.
  int operator()(std::size_t i, std::size_t j) const { return of_[i % m_ * n_ + j % n_]; }
  /// The score of a step from a span: that of the step's triangle and of the span that it leads to.
  int of(std::size_t i, std::size_t j, Step step) const {
    const int of_span = (*this)(i + (step == along_lower), j + (step == along_upper));
    return of_span + (of_step_[step].empty() ? 0 : of_step_[step][i % m_ * n_ + j % n_]);
  }

 private:
  static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

  /// Twice the largest distance from a point to the nearest point of the other ring, plus the longest side.
  /// Every strip has a span of at least the largest distance. Longer spans than this limit leave their
  /// neighbourhood and score as those that cross the most sides. Without the limit, most of the time would be
  /// spent on them.
  static double reach_of(const Ring& lower, const Ring& upper) {
    constexpr double far = std::numeric_limits<double>::infinity();
    std::vector<double> of_upper(upper.points_mm.size(), far);
    double farthest = 0.0, longest_side_mm = 0.0;
    for (const glm::dvec2& a : lower.points_mm) {
      double nearest = far;
      for (std::size_t j = 0; j < of_upper.size(); ++j) {
        const glm::dvec2 d = upper.points_mm[j] - a;
        const double square = glm::dot(d, d);
        nearest = std::min(nearest, square);
        of_upper[j] = std::min(of_upper[j], square);
      }
      farthest = std::max(farthest, nearest);
    }
    for (const double square : of_upper) farthest = std::max(farthest, square);
    for (const Ring* ring : {&lower, &upper})
      for (std::size_t k = 0; k < ring->points_mm.size(); ++k)
        longest_side_mm =
            std::max(longest_side_mm,
                     glm::distance(ring->points_mm[k], ring->points_mm[(k + 1) % ring->points_mm.size()]));
    return 2.0 * std::sqrt(farthest) + longest_side_mm;
  }

  /// Whether the direction from a ring's point starts on the ring's left, where the object is.
  static bool starts_inside(const Ring& ring, std::size_t at, const glm::dvec2& to) {
    const std::size_t count = ring.points_mm.size();
    const glm::dvec2& p = ring.points_mm[at];
    const glm::dvec2 in = p - ring.points_mm[(at + count - 1) % count];
    const glm::dvec2 out = ring.points_mm[(at + 1) % count] - p, way = to - p;
    const bool left_of_in = cross(in, way) > 0.0, left_of_out = cross(out, way) > 0.0;
    return cross(in, out) > 0.0 ? left_of_in && left_of_out : left_of_in || left_of_out;
  }

  std::size_t m_, n_;
  std::vector<std::uint8_t> of_;
  std::array<std::vector<int>, 2> of_step_;  ///< empty if no triangle is to be avoided
};

/// Among the pairs of points with the lowest score, the pair that is nearest after both rings are scaled to
/// the unit square.
std::array<std::size_t, 2> start_of(const Ring& lower, const Ring& upper, const Blame* blame = nullptr) {
  const auto a = in_unit_square(lower.points_mm), b = in_unit_square(upper.points_mm);
  std::array<std::size_t, 2> start{};
  std::pair least{std::numeric_limits<int>::max(), std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const glm::dvec2 d = b[j] - a[i];
      const std::pair here{blame != nullptr ? (*blame)(i, j) : 0, glm::dot(d, d)};
      if (here >= least) continue;
      least = here;
      start = {i, j};
    }
  return start;
}

std::vector<glm::dvec3> turned(const Ring& ring, std::size_t start) {
  assert(start < ring.points_mm.size());
  std::vector<glm::dvec3> points;
  for (std::size_t k = 0; k <= ring.points_mm.size(); ++k)
    points.emplace_back(ring.points_mm[(start + k) % ring.points_mm.size()], ring.z_mm);
  return points;
}

std::vector<Step> greedy_steps(const Ring& lower, const Ring& upper, std::array<std::size_t, 2> start,
                               const Blame* blame = nullptr) {
  const auto a = turned({in_unit_square(lower.points_mm), 0.0}, start[0]);
  const auto b = turned({in_unit_square(upper.points_mm), 0.0}, start[1]);
  std::vector<Step> steps;
  for (std::size_t i = 0, j = 0; i + 1 < a.size() || j + 1 < b.size();) {
    const bool lower_left = i + 1 < a.size(), upper_left = j + 1 < b.size();
    const auto next = [&](Step step) {
      return std::pair{blame != nullptr ? blame->of(start[0] + i, start[1] + j, step) : 0,
                       glm::distance(a[i + (step == along_lower)], b[j + (step == along_upper)])};
    };
    const bool lower_is_nearer = lower_left && upper_left && next(along_lower) <= next(along_upper);
    steps.push_back(!upper_left || lower_is_nearer ? along_lower : along_upper);
    ++(steps.back() == along_lower ? i : j);
  }
  return steps;
}

/// A path once around both rings from node (0, start), as its last column in each row.
struct Path {
  std::size_t start = 0;
  double cost = 0.0;
  std::vector<std::size_t> last;

  std::size_t first(std::size_t row) const { return row == 0 ? start : last[row - 1]; }
};

/// The path of least cost among all starts (Fuchs, Kedem and Uselton 1977).
class LeastPath {
 public:
  /// With `blame`, the least cost among the paths with the lowest sum of scores; `start` is the pair's start
  /// in its rings.
  LeastPath(const Pair& pair, TileCost cost, const Blame* blame = nullptr,
            const std::array<std::size_t, 2>& start = {0, 0})
      : m_(pair.m()), n_(pair.n()) {
    const glm::dvec3 tip = pair.lower.front();
    // A step's own span is the one that it leads to: c to b along the lower ring, a to c along the upper one.
    const auto cost_of = [&](const Triangle& t, Step step) {
      if (cost == TileCost::shortest_span) return glm::distance(step == along_lower ? t.b : t.a, t.c);
      return cost == TileCost::least_area ? 0.5 * glm::length(t.normal())
                                          : -glm::dot(t.a - tip, t.normal()) / 6.0;
    };
    for (const Step step : {along_lower, along_upper}) {
      costs_[step].resize((m_ + 1) * (n_ + 1));
      for (std::size_t i = 0; i + (step == along_lower) <= m_; ++i)
        for (std::size_t j = 0; j + (step == along_upper) <= n_; ++j)
          costs_[step][i * (n_ + 1) + j] = cost_of(pair.triangle(i, j, step), step);
    }
    if (blame == nullptr) return;
    // An upper bound on the difference between the costs of two strips.
    double dearest = 0.0;
    for (const std::vector<double>& costs : costs_)
      for (const double cost_of_one : costs) dearest = std::max(dearest, std::abs(cost_of_one));
    const double weight = 2.0 * dearest * static_cast<double>(m_ + n_);
    for (const Step step : {along_lower, along_upper})
      for (std::size_t i = 0; i + (step == along_lower) <= m_; ++i)
        for (std::size_t j = 0; j + (step == along_upper) <= n_; ++j)
          costs_[step][i * (n_ + 1) + j] += weight * blame->of(start[0] + i, start[1] + j, step);
  }

  /// The least path from (0, 0) between two other paths.
  Path find_between(const Path& low, const Path& high) const { return from(0, &low, &high); }

  /// The path of least cost from (0, 0) to (m, n).
  Path find_from_start() const { return from(0, nullptr, nullptr); }

  Path find() const {
    const Path low = from(0, nullptr, nullptr);
    Path high = low, best = low;
    high.start += n_;
    for (std::size_t& column : high.last) column += n_;
    search(low, high, best);
    return best;
  }

  /// The path of least cost from (0, 0) to (m, n) whose strip is a surface, which means that its steps along
  /// the upper ring start at two or more points of the lower ring. Any other strip contains a span twice.
  /// With three points on each ring such a path exists.
  std::vector<Step> surface_steps() const {
    // The points of the lower ring at which the steps along the upper ring have started so far.
    enum Held : std::uint8_t { nowhere, at_start, here, behind, at_two, held_count };
    constexpr double far = std::numeric_limits<double>::infinity();
    struct Came {
      Step step = along_lower;
      Held from = nowhere;
    };
    const auto after = [&](Held held, std::size_t row, Step step) {
      if (step == along_lower) return held == here ? behind : held;
      const bool is_start = row == 0 || row == m_;
      if (held == nowhere) return is_start ? at_start : here;
      if (held == at_start) return is_start ? at_start : at_two;
      return held == here ? here : at_two;
    };
    std::vector<std::array<double, held_count>> least((m_ + 1) * (n_ + 1));
    std::vector<std::array<Came, held_count>> came(least.size());
    for (auto& node : least) node.fill(far);
    least[0][nowhere] = 0.0;
    for (std::size_t i = 0; i <= m_; ++i)
      for (std::size_t j = 0; j <= n_; ++j)
        for (const Step step : {along_lower, along_upper}) {
          if (step == along_lower ? i == m_ : j == n_) continue;
          const std::size_t at = i * (n_ + 1) + j, to = at + (step == along_lower ? n_ + 1 : 1);
          for (std::uint8_t h = 0; h < held_count; ++h) {
            const double total = least[at][h] + costs_[step][at];
            const Held held = after(static_cast<Held>(h), i, step);
            if (!(total < least[to][held])) continue;
            least[to][held] = total;
            came[to][held] = {step, static_cast<Held>(h)};
          }
        }
    std::vector<Step> steps;
    Held held = at_two;
    for (std::size_t i = m_, j = n_; i > 0 || j > 0;) {
      const Came& last = came[i * (n_ + 1) + j][held];
      steps.push_back(last.step);
      --(last.step == along_lower ? i : j);
      held = last.from;
    }
    return {steps.rbegin(), steps.rend()};
  }

 private:
  /// Columns beyond n continue at the ring's start.
  double cost(std::size_t i, std::size_t j, Step step) const {
    return costs_[step][i * (n_ + 1) + (j < n_ ? j : j - n_)];
  }

  void search(const Path& low, const Path& high, Path& best) const {
    if (high.start - low.start < 2) return;
    const Path middle = from((low.start + high.start) / 2, &low, &high);
    if (middle.cost < best.cost || (middle.cost == best.cost && middle.start < best.start)) best = middle;
    search(low, middle, best);
    search(middle, high, best);
  }

  /// The path of least cost from a start; it stays between `low` and `high` if these are given.
  Path from(std::size_t start, const Path* low, const Path* high) const {
    const auto begin = [&](std::size_t i) { return low ? std::max(low->first(i), start) : start; };
    const auto end = [&](std::size_t i) { return high ? std::min(high->last[i], start + n_) : start + n_; };
    std::vector<std::vector<Step>> came(m_ + 1);
    std::vector<double> row, above;
    for (std::size_t i = 0; i <= m_; ++i) {
      above.swap(row);
      row.assign(end(i) - begin(i) + 1, std::numeric_limits<double>::infinity());
      came[i].assign(row.size(), along_upper);
      for (std::size_t j = begin(i); j <= end(i); ++j) {
        double& least = row[j - begin(i)];
        if (i == 0 && j == start) least = 0.0;
        if (j > begin(i)) least = std::min(least, row[j - 1 - begin(i)] + cost(i, j - 1, along_upper));
        if (i == 0 || j < begin(i - 1) || j > end(i - 1)) continue;
        const double by_lower = above[j - begin(i - 1)] + cost(i - 1, j, along_lower);
        if (by_lower >= least) continue;
        least = by_lower;
        came[i][j - begin(i)] = along_lower;
      }
    }
    Path path{start, row.back(), std::vector<std::size_t>(m_ + 1)};
    path.last[m_] = start + n_;
    for (std::size_t i = m_, j = start + n_; i > 0;) {
      if (came[i][j - begin(i)] == along_upper) {
        --j;
        continue;
      }
      path.last[--i] = j;
    }
    return path;
  }

  std::size_t m_, n_;
  std::array<std::vector<double>, 2> costs_;  ///< cost of each step from (i, j), at i * (n + 1) + j
};

std::vector<Step> steps_of(const Path& path) {
  std::vector<Step> steps;
  for (std::size_t i = 0; i < path.last.size(); ++i) {
    if (i > 0) steps.push_back(along_lower);
    steps.insert(steps.end(), path.last[i] - path.first(i), along_upper);
  }
  return steps;
}

/// The span at which a path's strip degenerates into two cones: all steps along one ring start at one point
/// of the other.
std::optional<std::array<std::size_t, 2>> neck_of(const Path& path, std::size_t n) {
  const std::size_t m = path.last.size() - 1;
  for (std::size_t i = 0; i < m; ++i) {
    const std::size_t steps = path.last[i] - path.first(i) + (i == 0 ? path.last[m] - path.first(m) : 0);
    if (steps == n) return std::array{i, path.last[i] % n};
  }
  return {};
}

/// Angle between the planes of two triangles; 0 if one has no area.
double angle_between(const glm::dvec3& n, const glm::dvec3& m) {
  return std::atan2(glm::length(glm::cross(n, m)), glm::dot(n, m));
}

/// The columns of each row that a search may enter.
struct Band {
  Path low, high;
  std::size_t begin(std::size_t row) const { return low.first(row); }
  std::size_t end(std::size_t row) const { return high.last[row]; }
};

/// All columns.
Band all_of(const Pair& pair) {
  const std::size_t rows = pair.m() + 1;
  return {{0, 0.0, std::vector<std::size_t>(rows, 0)}, {0, 0.0, std::vector<std::size_t>(rows, pair.n())}};
}

/// The columns within `reach` of those of a path of steps from (0, 0).
Band about(const std::vector<Step>& steps, const Pair& pair, std::size_t reach) {
  Band band = all_of(pair);
  std::size_t row = 0, column = 0;
  for (const Step step : steps) {
    if (step == along_upper) {
      ++column;
      continue;
    }
    band.high.last[row] = std::min(pair.n(), column + reach);
    band.low.last[row++] = column - std::min(column, reach);
  }
  return band;
}

/// The path from (0, 0) within a band with the least sum of angles. A node has a sum for each step that may
/// have led to it, as an angle is between the triangle of that step and the next.
std::vector<Step> least_angle_steps(const Pair& pair, const Band& band,
                                    std::array<std::size_t, 2> start = {0, 0}, const Blame* blame = nullptr) {
  const std::size_t m = pair.m(), n = pair.n();
  // An upper bound on the sum of a strip's angles.
  const double weight = 4.0 * static_cast<double>(m + n);
  constexpr double far = std::numeric_limits<double>::infinity();
  using Sums = std::array<double, 2>;
  std::vector<Sums> row(n + 1, {far, far}), above;
  std::vector<std::array<Step, 2>> came((m + 1) * (n + 1));
  for (std::size_t i = 0; i <= m; ++i) {
    above.swap(row);
    row.assign(n + 1, {far, far});
    for (std::size_t j = band.begin(i); j <= band.end(i); ++j) {
      if (i == 0 && j == 0) {
        row[0] = {0.0, 0.0};
        continue;
      }
      for (const Step step : {along_lower, along_upper}) {
        if (step == along_lower ? i == 0 : j == 0) continue;
        const std::size_t from_i = step == along_lower ? i - 1 : i, from_j = step == along_lower ? j : j - 1;
        const Sums& from = step == along_lower ? above[j] : row[j - 1];
        const Triangle here = pair.triangle(from_i, from_j, step);
        const double blamed =
            blame != nullptr ? weight * blame->of(start[0] + from_i, start[1] + from_j, step) : 0.0;
        for (const Step before : {along_lower, along_upper}) {
          if (from[before] == far) continue;
          double total = from[before] + blamed;
          if (from_i > 0 || from_j > 0) {
            const Triangle last = before == along_lower ? pair.triangle(from_i - 1, from_j, before)
                                                        : pair.triangle(from_i, from_j - 1, before);
            total += angle_between(last.normal(), here.normal());
          }
          if (total >= row[j][step]) continue;
          row[j][step] = total;
          came[i * (n + 1) + j][step] = before;
        }
      }
    }
  }
  std::vector<Step> steps;
  Step step = row[n][along_lower] <= row[n][along_upper] ? along_lower : along_upper;
  for (std::size_t i = m, j = n; i > 0 || j > 0;) {
    steps.push_back(step);
    const Step before = came[i * (n + 1) + j][step];
    --(step == along_lower ? i : j);
    step = before;
  }
  return {steps.rbegin(), steps.rend()};
}

/// About 1 GB: 17 bytes per pair of points, or 2 for the least angle.
std::size_t most_pairs(TileCost cost) {
  return std::size_t{1} << (cost == TileCost::least_angle ? 29 : 26);
}

void check(const Ring& lower, const Ring& upper, TileCost cost) {
  for (const Ring* ring : {&lower, &upper})
    if (ring->points_mm.size() < 3)
      throw std::invalid_argument("tile: a ring has " + std::to_string(ring->points_mm.size()) +
                                  " points, three are needed");
  if (!(lower.z_mm < upper.z_mm)) throw std::invalid_argument("tile: the lower ring must lie lower");
  if (cost != TileCost::shortest_span && lower.points_mm.size() * upper.points_mm.size() > most_pairs(cost))
    throw Error(ErrorCode::Resource,
                "tile: rings of " + std::to_string(lower.points_mm.size()) + " and " +
                    std::to_string(upper.points_mm.size()) + " points, at " + short_text(lower.z_mm) +
                    " mm, are too long for this cost: thin them, or take the shortest span");
}

/// The triangles of a path from a start.
std::vector<std::array<std::uint32_t, 3>> faces_of(const Ring& lower, const Ring& upper,
                                                   const std::array<std::size_t, 2>& start,
                                                   const std::vector<Step>& steps) {
  const std::size_t m = lower.points_mm.size(), n = upper.points_mm.size();
  const auto lower_point = [&](std::size_t i) { return static_cast<std::uint32_t>((start[0] + i) % m); };
  const auto upper_point = [&](std::size_t j) { return static_cast<std::uint32_t>(m + (start[1] + j) % n); };
  assert(steps.size() == m + n);
  std::vector<std::array<std::uint32_t, 3>> faces;
  std::size_t i = 0, j = 0;
  for (const Step step : steps) {
    if (step == along_lower) {
      faces.push_back({lower_point(i), lower_point(i + 1), upper_point(j)});
      ++i;
    } else {
      faces.push_back({upper_point(j + 1), upper_point(j), lower_point(i)});
      ++j;
    }
  }
  return faces;
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> tile(const Ring& lower, const Ring& upper, TileCost cost) {
  check(lower, upper, cost);
  if (cost == TileCost::least_area || cost == TileCost::greatest_volume) {
    const Path path = LeastPath({turned(lower, 0), turned(upper, 0)}, cost).find();
    return faces_of(lower, upper, {0, path.start}, steps_of(path));
  }
  const std::array<std::size_t, 2> start = start_of(lower, upper);
  if (cost == TileCost::shortest_span)
    return faces_of(lower, upper, start, greedy_steps(lower, upper, start));
  const Pair pair{turned(lower, start[0]), turned(upper, start[1])};
  return faces_of(lower, upper, start, least_angle_steps(pair, all_of(pair)));
}

std::vector<std::array<std::uint32_t, 3>> tile_clear(
    const Ring& lower, const Ring& upper, TileCost cost, const SpanClearance& sides,
    const std::vector<std::array<std::uint32_t, 3>>& avoided) {
  check(lower, upper, cost);
  const Blame blame(lower, upper, sides, avoided);
  if (cost == TileCost::least_area || cost == TileCost::greatest_volume) {
    const Path path = LeastPath({turned(lower, 0), turned(upper, 0)}, cost, &blame).find();
    const auto neck = neck_of(path, upper.points_mm.size());
    if (!neck) return faces_of(lower, upper, {0, path.start}, steps_of(path));
    const Pair pair{turned(lower, (*neck)[0]), turned(upper, (*neck)[1])};
    return faces_of(lower, upper, *neck, LeastPath(pair, cost, &blame, *neck).surface_steps());
  }
  const std::array<std::size_t, 2> start = start_of(lower, upper, &blame);
  const bool has_room = lower.points_mm.size() * upper.points_mm.size() <= most_pairs(TileCost::least_area);
  if (cost == TileCost::shortest_span && (avoided.empty() || !has_room))
    return faces_of(lower, upper, start, greedy_steps(lower, upper, start, &blame));
  const Pair pair{turned(lower, start[0]), turned(upper, start[1])};
  if (cost == TileCost::least_angle)
    return faces_of(lower, upper, start, least_angle_steps(pair, all_of(pair), start, &blame));
  const LeastPath spans(pair, cost, &blame, start);
  const Path path = spans.find_from_start();
  return faces_of(lower, upper, start,
                  neck_of(path, upper.points_mm.size()) ? spans.surface_steps() : steps_of(path));
}

std::vector<std::array<std::uint32_t, 3>> tile_near(const Ring& lower, const Ring& upper, TileCost cost,
                                                    std::size_t band) {
  check(lower, upper, cost);
  const std::array<std::size_t, 2> start = start_of(lower, upper);
  const std::vector<Step> shortest = greedy_steps(lower, upper, start);
  if (cost == TileCost::shortest_span || band == 0) return faces_of(lower, upper, start, shortest);
  const Pair pair{turned(lower, start[0]), turned(upper, start[1])};
  const Band within = about(shortest, pair, band);
  const std::vector<Step> steps = cost == TileCost::least_angle
                                      ? least_angle_steps(pair, within)
                                      : steps_of(LeastPath(pair, cost).find_between(within.low, within.high));
  return faces_of(lower, upper, start, steps);
}

}  // namespace octotomy::brep
