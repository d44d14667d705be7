// SPDX-License-Identifier: AGPL-3.0-or-later
// A strip is a path in a graph: node (i, j) is the span from the lower ring's point i to the upper ring's
// point j, and a step to (i + 1, j) or (i, j + 1) is a triangle. A path's sum is first the blame of its
// spans, which is 0 unless spans are to be clear of contours, then its cost. Passes: 1 choose the start; 2
// walk greedily from there, or 3 find the path with the least sum among those near the greedy one. No better
// path has a larger sum at any node, so 4 find the path with the least sum over nodes whose sums do not
// exceed that limit, after trials with smaller limits of the blame. If costs depend on single triangles, the
// strip may start elsewhere: every strip has a span at the lower ring's first point. Therefore 5 find the
// path that starts half way between two known ones, which it need not cross, and so on; 6 write the triangles
// of the best.
// Over 600 lines, because all passes share the rings' scores, costs and bounds.
// Departure from Fuchs, Kedem and Uselton: nodes with a larger sum than a known path are left out. This
// changes no result, because no step has a negative cost; of greatest_volume only the blame is limited.
#include "brep/contour/tile.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <compare>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

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

  /// The triangle between the span of lower point i and upper point j and the span to which the step leads.
  Triangle triangle(std::size_t i, std::size_t j, Step step) const {
    assert(i + (step == along_lower) <= m() && j + (step == along_upper) <= n());
    return step == along_lower ? Triangle{lower[i], lower[i + 1], upper[j]}
                               : Triangle{upper[j + 1], upper[j], lower[i]};
  }
  std::size_t m() const { return lower.size() - 1; }
  std::size_t n() const { return upper.size() - 1; }
};

struct PointBox {
  glm::dvec2 low{0.0}, extent{1.0};
};
PointBox box_of(const std::vector<glm::dvec2>& points) {
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const glm::dvec2& p : points) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  return {low, glm::max(high - low, glm::dvec2(std::numeric_limits<double>::min()))};
}

/// The points moved and scaled so that their box is another one, by default the unit square.
std::vector<glm::dvec2> in_box(const std::vector<glm::dvec2>& points, const PointBox& box = {}) {
  const PointBox own = box_of(points);
  std::vector<glm::dvec2> scaled;
  scaled.reserve(points.size());
  for (const glm::dvec2& p : points) scaled.push_back((p - own.low) / own.extent * box.extent + box.low);
  return scaled;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// The most crossings of a span that are counted.
constexpr int most_crossed = 6;

/// The score of a span between two points, by their numbers in the rings; lower is better.
using SpanScore = std::function<int(std::size_t, std::size_t)>;

/// Scores spans in projection. 0: the span lies over the area of exactly one ring and crosses no side. 1: it
/// lies over both areas or neither, as where the rings cross. Otherwise more for each side that it crosses.
class ScoreInPlane {
 public:
  ScoreInPlane(const Ring& lower, const Ring& upper, const SpanClearance& sides)
      : lower_(lower), upper_(upper), sides_(sides), reach_mm_(reach_of(lower, upper)) {}

  int operator()(std::size_t i, std::size_t j) const {
    const glm::dvec2 &a = lower_.points_mm[i], &b = upper_.points_mm[j];
    const int crossed = glm::distance(a, b) > reach_mm_ ? most_crossed : sides_.crossed(a, b, most_crossed);
    const bool is_beside = starts_inside(lower_, i, b) != starts_inside(upper_, j, a);
    return crossed > 0 ? 1 + crossed : is_beside ? 0 : 1;
  }

 private:
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

  const Ring &lower_, &upper_;
  const SpanClearance& sides_;
  double reach_mm_;
};

/// Scores the spans between two rings, each once.
class Blame {
 public:
  Blame(const Ring& lower, const Ring& upper, SpanScore score,
        const std::vector<std::array<std::uint32_t, 3>>& avoided, std::vector<std::uint8_t>& scores)
      : m_(lower.points_mm.size()), n_(upper.points_mm.size()), score_(std::move(score)), of_(scores) {
    of_.resize(m_ * n_, unknown);
    for (const auto& face : avoided) {
      const Step step = face[2] < m_ ? along_upper : along_lower;
      const std::size_t i = step == along_lower ? face[0] : face[2];
      const std::size_t j = (step == along_lower ? face[2] : face[1]) - m_;
      ++of_step_[step][i * n_ + j];
    }
  }

  /// The score of the span between two points; numbers beyond the rings' ends continue at their starts. Not for
  /// two threads at once, because scores are computed when they are first needed.
  int operator()(std::size_t i, std::size_t j) const {
    std::uint8_t& score = of_[i % m_ * n_ + j % n_];
    if (score == unknown) score = static_cast<std::uint8_t>(score_(i % m_, j % n_));
    return score;
  }
  /// For each lower point, the lowest score of its spans; then the same for each upper point.
  std::array<std::vector<int>, 2> least() const {
    return {least_of(m_, n_, [&](std::size_t i, std::size_t j) { return (*this)(i, j); }),
            least_of(n_, m_, [&](std::size_t j, std::size_t i) { return (*this)(i, j); })};
  }
  /// The score of a step from a span: the score of the step's triangle plus the score of the span to which
  /// the step leads.
  int of(std::size_t i, std::size_t j, Step step) const {
    const int of_span = (*this)(i + (step == along_lower), j + (step == along_upper));
    if (of_step_[step].empty()) return of_span;
    const auto avoided = of_step_[step].find(i % m_ * n_ + j % n_);
    return of_span + (avoided == of_step_[step].end() ? 0 : avoided->second);
  }

 private:
  static constexpr std::uint8_t unknown = 255;

  /// The lowest score at each point of one ring, over the points of the other ring. Each search begins at the
  /// point at which the one before it ended, and ends at the first score of 0.
  template <typename Score>
  static std::vector<int> least_of(std::size_t count, std::size_t others, const Score& score) {
    std::vector<int> least(count, unknown);
    std::size_t near = 0;
    for (std::size_t k = 0; k < count; ++k) {
      std::size_t found = near;
      for (std::size_t away = 0; 2 * away <= others && least[k] > 0; ++away)
        for (const std::size_t other : {(near + away) % others, (near + others - away) % others}) {
          const int here = score(k, other);
          if (here >= least[k]) continue;
          least[k] = here;
          found = other;
        }
      near = found;
    }
    return least;
  }

  std::size_t m_, n_;
  SpanScore score_;
  std::vector<std::uint8_t>& of_;
  std::array<std::unordered_map<std::size_t, int>, 2> of_step_;  ///< scores of triangles to be avoided
};

/// Among the pairs of points with the lowest score, the pair that is nearest after both rings are scaled to
/// the unit square.
std::array<std::size_t, 2> start_of(const Ring& lower, const Ring& upper, const Blame* blame = nullptr) {
  const auto a = in_box(lower.points_mm), b = in_box(upper.points_mm);
  std::array<std::size_t, 2> start{};
  std::pair least{std::numeric_limits<int>::max(), std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      const glm::dvec2 d = b[j] - a[i];
      const double square = glm::dot(d, d);
      if (std::pair{0, square} >= least) continue;
      const std::pair here{blame != nullptr ? (*blame)(i, j) : 0, square};
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
  const auto a = turned({in_box(lower.points_mm), 0.0}, start[0]);
  const auto b = turned({in_box(upper.points_mm), 0.0}, start[1]);
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

/// A path once around both rings. Node (i, j) is the span between lower point i and upper point j. The path
/// begins at node (0, start) and is stored as its last column j in each row i.
struct Path {
  std::size_t start = 0;
  std::vector<std::size_t> last;

  std::size_t first(std::size_t row) const { return row == 0 ? start : last[row - 1]; }
};

Path path_of(const std::vector<Step>& steps, std::size_t start) {
  Path path{start, {}};
  std::size_t column = start;
  for (const Step step : steps) {
    if (step == along_upper)
      ++column;
    else
      path.last.push_back(column);
  }
  path.last.push_back(column);
  return path;
}

/// The span at which a path's strip degenerates into two cones, because all steps along one ring begin at one
/// point of the other. None if it does not degenerate.
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

/// The band of all paths. A path starts at one of the n points of the upper ring and ends n columns farther,
/// so it stays within the columns 0 to 2n.
Band all_of(const Pair& pair) {
  const std::size_t rows = pair.m() + 1;
  return {{0, std::vector<std::size_t>(rows, 0)}, {0, std::vector<std::size_t>(rows, 2 * pair.n())}};
}

/// The columns within `reach` of the path that these steps make from (0, 0).
Band about(const std::vector<Step>& steps, std::size_t reach) {
  Band band{path_of(steps, 0), path_of(steps, 0)};
  for (std::size_t& column : band.low.last) column -= std::min(column, reach);
  for (std::size_t& column : band.high.last) column += reach;
  return band;
}

/// The cost of a path: the blame of its steps and the sum of their costs. Blame is compared first.
struct Sum {
  int blame = 0;
  double cost = 0.0;
  std::partial_ordering operator<=>(const Sum&) const = default;
};
constexpr Sum no_limit{std::numeric_limits<int>::max(), std::numeric_limits<double>::infinity()};

/// A path of least cost that begins at column `start`.
struct Found {
  Sum sum;
  std::size_t start = 0;
  std::vector<Step> steps;
};

/// Finds paths of least sum between two rings.
class LeastPath {
 public:
  /// `start`: the points of both rings at which the pair begins.
  LeastPath(const Pair& pair, TileCost cost, const std::array<std::size_t, 2>& start,
            const Blame* blame = nullptr)
      : pair_(pair), cost_(cost), start_(start), blame_(blame), m_(pair.m()), n_(pair.n()) {}

  /// The path of least sum from (0, 0). The sum of the best path near `steps_near` limits the search.
  Found find_from_start(const std::vector<Step>& steps_near) {
    bound_rest();
    constexpr std::size_t reach = 8;
    const Sum known = from(0, about(steps_near, reach), no_limit)->sum;
    const Band all = all_of(pair_);
    // Tries low limits first: most strips need little blame, and with a low limit few nodes are reached.
    const int least = least_rest(0, 0, 0).blame;
    for (int more = 0; least + more < known.blame; more = std::max(1, 4 * more))
      if (auto found = from(0, all, {least + more, no_limit.cost})) return *std::move(found);
    return *from(0, all, limit(known));
  }

  /// The path of least sum from (0, 0) in a band. Precondition: the band holds a path.
  Found find_in(const Band& band) { return *from(0, band, no_limit); }

  /// The path of least sum among all starts.
  Found find(const std::vector<Step>& steps_near) {
    Found best = find_from_start(steps_near);
    const Path low = path_of(best.steps, 0);
    Path high = low;
    high.start += n_;
    for (std::size_t& column : high.last) column += n_;
    search({low, high}, 0, n_, best);
    return best;
  }

  /// The path of least sum from (0, 0) to (m, n) whose strip is a surface: its steps along the upper ring
  /// start at two or more points of the lower ring. Any other strip contains a span twice. With three points
  /// on each ring such a path exists. For costs of single triangles.
  std::vector<Step> surface_steps() const {
    // The points of the lower ring at which the steps along the upper ring have started so far.
    enum Held : std::uint8_t { nowhere, at_start, here, behind, at_two, held_count };
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
    std::array<Sum, held_count> unreached;
    unreached.fill(no_limit);
    std::vector<std::array<Sum, held_count>> row(n_ + 1, unreached), next(n_ + 1, unreached);
    std::vector<std::array<Came, held_count>> came((m_ + 1) * (n_ + 1));
    row[0][nowhere] = {};
    for (std::size_t i = 0; i <= m_; ++i) {
      for (std::size_t j = 0; j <= n_; ++j)
        for (const Step step : {along_lower, along_upper}) {
          if (step == along_lower ? i == m_ : j == n_) continue;
          const Triangle triangle = pair_.triangle(i, j, step);
          const Sum own{blame_of(i, j, step), own_cost(triangle, step, triangle.normal())};
          auto& to = step == along_lower ? next[j] : row[j + 1];
          for (std::uint8_t h = 0; h < held_count; ++h) {
            if (row[j][h] == no_limit) continue;
            const Sum total{row[j][h].blame + own.blame, row[j][h].cost + own.cost};
            const Held held = after(static_cast<Held>(h), i, step);
            if (!(total < to[held])) continue;
            to[held] = total;
            came[(i + (step == along_lower)) * (n_ + 1) + j + (step == along_upper)][held] = {
                step, static_cast<Held>(h)};
          }
        }
      row.swap(next);
      std::fill(next.begin(), next.end(), unreached);
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
  /// Up to this number of pairs of points, the least costs to the last row are stored: 128 MB.
  static constexpr std::size_t most_tabled = std::size_t{1} << 25;

  /// A node within the limit and the best path to it for each last step: the angle at the next step depends
  /// on the last triangle.
  struct Node {
    std::size_t column = 0;
    std::array<Sum, 2> sums{no_limit, no_limit};
    std::array<glm::dvec3, 2> normals{};  ///< of the last steps' triangles
    bool is_start = false;
    std::uint8_t came = 0;  ///< bit s: the step before last step s was along the upper ring
  };

  /// The nodes that a search has reached. Each row is a few runs of columns.
  struct Reached {
    struct Run {
      std::size_t column, node;
    };
    std::vector<std::vector<Run>> rows;
    std::vector<std::uint8_t> came;  ///< of each node

    void add(const Node& node) {
      std::vector<Run>& runs = rows.back();
      if (runs.empty() || came.size() - runs.back().node != node.column - runs.back().column)
        runs.push_back({node.column, came.size()});
      came.push_back(node.came);
    }
    std::uint8_t came_to(std::size_t row, std::size_t column) const {
      const std::vector<Run>& runs = rows[row];
      const auto after = std::upper_bound(runs.begin(), runs.end(), column,
                                          [](std::size_t c, const Run& run) { return c < run.column; });
      return came[(after - 1)->node + column - (after - 1)->column];
    }
  };

  /// Among paths with equal sums, the one with this last step is chosen.
  Step preferred() const { return cost_ == TileCost::least_angle ? along_lower : along_upper; }

  /// The limit for the sums at all nodes of a path whose sum at the end is at most `end`.
  Sum limit(const Sum& end) const {
    return {end.blame, cost_ == TileCost::greatest_volume ? no_limit.cost : end.cost};
  }

  /// Sums up the least blame and the least cost of a step to each row and to each column. The costs of angles
  /// and volumes have no bound and are left out.
  void bound_rest() {
    std::array least{std::vector<Sum>(m_, no_limit), std::vector<Sum>(n_, no_limit)};
    if (blame_ != nullptr) {
      const auto [of_lower, of_upper] = blame_->least();
      // The step from row i leads to row i + 1.
      for (std::size_t i = 0; i < m_; ++i) least[0][i].blame = of_lower[(start_[0] + i + 1) % m_];
      for (std::size_t j = 0; j < n_; ++j) least[1][j].blame = of_upper[(start_[1] + j + 1) % n_];
    }
    const bool is_bounded = cost_ == TileCost::least_area || cost_ == TileCost::shortest_span;
    const bool is_tabled = is_bounded && m_ * n_ <= most_tabled;
    if (is_tabled) to_end_.resize(m_ * n_);
    std::array own{std::vector<double>(n_), std::vector<double>(n_)};
    std::vector<double> below(n_, 0.0);
    for (std::size_t i = m_; i-- > 0 && is_bounded;) {
      for (std::size_t j = 0; j < n_; ++j)
        for (const Step step : {along_lower, along_upper}) {
          const Triangle triangle = pair_.triangle(i, j, step);
          own[step][j] = own_cost(triangle, step, triangle.normal());
          double& cost = least[step][step == along_lower ? i : j].cost;
          cost = std::min(cost, own[step][j]);
        }
      if (is_tabled) table_row(i, own, below);
    }
    const auto summed = [&](const std::vector<Sum>& steps, std::size_t count) {
      std::vector<Sum> sums(count + 1);
      for (std::size_t k = 0; k < count; ++k) {
        const Sum& step = steps[k % steps.size()];
        sums[k + 1] = {sums[k].blame + (blame_ != nullptr ? step.blame : 0),
                       sums[k].cost + (is_bounded ? step.cost : 0.0)};
      }
      return sums;
    };
    to_row_ = summed(least[0], m_);
    to_column_ = summed(least[1], 2 * n_);
  }

  /// Computes the least cost from each node of a row to the last row, at any column, from those of the row
  /// below. Steps along the row lead around the ring; two rounds suffice, because no cost is below zero.
  void table_row(std::size_t i, const std::array<std::vector<double>, 2>& own, std::vector<double>& below) {
    std::vector<double>& here = below;
    for (std::size_t j = 0; j < n_; ++j) here[j] += own[along_lower][j];
    for (std::size_t k = 2 * n_; k-- > 0;) {
      const std::size_t j = k % n_;
      here[j] = std::min(here[j], own[along_upper][j] + here[(j + 1) % n_]);
    }
    // A float's rounding, and that of the sum, must not raise the bound.
    constexpr double rounding = 1.0 - 0x1p-20;
    for (std::size_t j = 0; j < n_; ++j) to_end_[i * n_ + j] = static_cast<float>(rounding * here[j]);
  }

  /// A lower bound of the sum from a node to the end of a path that began at `start`. The path still has one
  /// step to each later row and one to each later column; each costs at least the least of all steps to that
  /// row or column. If to_end_ is stored, its entry for the node is a bound, too.
  Sum least_rest(std::size_t i, std::size_t j, std::size_t start) const {
    if (to_row_.empty()) return {};
    const Sum &row = to_row_[i], &column = to_column_[j], &last_row = to_row_[m_];
    const Sum& last_column = to_column_[start + n_];
    const double cost = last_row.cost - row.cost + last_column.cost - column.cost;
    const bool is_tabled = !to_end_.empty() && i < m_;
    return {last_row.blame - row.blame + last_column.blame - column.blame,
            is_tabled ? std::max(cost, static_cast<double>(to_end_[i * n_ + j % n_])) : cost};
  }

  int blame_of(std::size_t i, std::size_t j, Step step) const {
    return blame_ != nullptr ? blame_->of(start_[0] + i, start_[1] + j, step) : 0;
  }

  /// A triangle's cost apart from angles.
  double own_cost(const Triangle& t, Step step, const glm::dvec3& normal) const {
    switch (cost_) {
      // A step's cost is the length of the span to which it leads: from b along the lower ring, from a along
      // the upper one.
      case TileCost::shortest_span:
        return glm::distance(step == along_lower ? t.b : t.a, t.c);
      case TileCost::least_area:
        return 0.5 * glm::length(normal);
      case TileCost::greatest_volume:
        return -glm::dot(t.a - pair_.lower.front(), normal) / 6.0;
      case TileCost::least_angle:
        return 0.0;
    }
    assert(false);
    return 0.0;
  }

  /// The aim of a search: a path from (0, start) with at most this sum.
  struct Aim {
    std::size_t start;
    Sum most;
  };

  /// Improves the paths to a node by those that lead through its neighbour (i, from.column).
  void arrive(Node& to, const Node& from, std::size_t i, Step step, const Aim& aim) const {
    const std::size_t j = from.column < n_ ? from.column : from.column - n_;
    const int blame = blame_of(i, j, step);
    const Sum rest = least_rest(i + (step == along_lower), to.column, aim.start);
    // Refuses a step before its own cost is computed: where costs have a limit, none is below zero.
    const Sum& least = std::min(from.sums[0], from.sums[1]);
    if (Sum{least.blame + blame + rest.blame, least.cost + rest.cost} > aim.most) return;
    const Triangle triangle = pair_.triangle(i, j, step);
    const glm::dvec3 normal = triangle.normal();
    const double cost = own_cost(triangle, step, normal);
    to.normals[step] = normal;
    for (const Step before : {preferred(), preferred() == along_lower ? along_upper : along_lower}) {
      if (from.sums[before] == no_limit) continue;
      Sum total{from.sums[before].blame + blame, from.sums[before].cost + cost};
      const auto is_better = [&] {
        return total < to.sums[step] && Sum{total.blame + rest.blame, total.cost + rest.cost} <= aim.most;
      };
      // An angle adds to the cost and never lowers it.
      if (!is_better()) continue;
      if (cost_ == TileCost::least_angle && !from.is_start)
        total.cost += angle_between(from.normals[before], normal);
      if (!is_better()) continue;
      to.sums[step] = total;
      to.came = static_cast<std::uint8_t>((to.came & ~(1u << step)) | (unsigned{before} << step));
    }
  }

  /// The path of least sum from (0, start) to (m, start + n) in a band. None if on every path some node's
  /// sum, plus least_rest() from there, exceeds `most`.
  std::optional<Found> from(std::size_t start, const Band& band, const Sum& most) {
    // Sums in another order differ by rounding, a part of 2^-53 for each of their terms.
    const double rounding = 0x1p-50 * static_cast<double>(m_ + n_);
    reached_count_ = 0;
    const Aim aim{start, {most.blame, most.cost + rounding * std::abs(most.cost)}};
    if (least_rest(0, start, start) > aim.most) return {};
    if (blame_ != nullptr && (*blame_)(start_[0], start_[1] + start) > most.blame) return {};
    Reached reached;
    std::vector<Node> row, above;
    for (std::size_t i = 0; i <= m_; ++i) {
      above.swap(row);
      row.clear();
      reached.rows.emplace_back();
      const std::size_t begin = std::max(band.begin(i), start), end = std::min(band.end(i), start + n_);
      auto lower =
          std::lower_bound(above.begin(), above.end(), begin,
                           [](const Node& node, std::size_t column) { return node.column < column; });
      if (i == 0) {
        row.push_back({start});
        row.back().is_start = true;
        row.back().sums[preferred()] = {};
        reached.add(row.back());
      }
      // The next column of this row follows the last one, or lies below a node of the row above.
      for (bool goes_on = i == 0;;) {
        Node node;
        const bool by_upper = goes_on && row.back().column < end;
        const bool by_lower = lower != above.end() && lower->column <= end &&
                              (!by_upper || lower->column <= row.back().column + 1);
        if (!by_upper && !by_lower) break;
        node.column = by_lower ? lower->column : row.back().column + 1;
        if (by_upper && node.column == row.back().column + 1) arrive(node, row.back(), i, along_upper, aim);
        if (by_lower) arrive(node, *lower++, i - 1, along_lower, aim);
        goes_on = node.sums[along_lower] != no_limit || node.sums[along_upper] != no_limit;
        if (!goes_on) continue;
        row.push_back(node);
        reached.add(node);
      }
      reached_count_ = reached.came.size();
      if (row.empty()) return {};
    }
    if (row.back().column != start + n_) return {};
    const std::array<Sum, 2>& sums = row.back().sums;
    const Step other = preferred() == along_lower ? along_upper : along_lower;
    Step step = sums[preferred()] <= sums[other] ? preferred() : other;
    Found found{sums[step], start, {}};
    for (std::size_t i = m_, j = start + n_; i > 0 || j > start;) {
      found.steps.push_back(step);
      const Step before = (reached.came_to(i, j) >> step & 1u) != 0 ? along_upper : along_lower;
      --(step == along_lower ? i : j);
      step = before;
    }
    std::reverse(found.steps.begin(), found.steps.end());
    return found;
  }

  /// Searches for paths that begin after column `after` and before column `before` and lie between both paths
  /// of `between`; updates the best.
  void search(const Band& between, std::size_t after, std::size_t before, Found& best) {
    if (before - after < 2) return;
    const std::size_t middle = (after + before) / 2;
    auto found = from(middle, between, limit(best.sum));
    // A failed search does not narrow the bands of later ones. Once failed searches have reached as many
    // nodes as a search without a limit, such a search is made for this start: its path narrows the bands.
    if (!found && (failed_count_ += reached_count_) > m_ * n_) {
      failed_count_ = 0;
      found = from(middle, between, no_limit);
    }
    if (!found) {
      search(between, after, middle, best);
      search(between, middle, before, best);
      return;
    }
    const Path path = path_of(found->steps, middle);
    if (found->sum < best.sum || (found->sum == best.sum && middle < best.start)) best = *std::move(found);
    search({between.low, path}, after, middle, best);
    search({path, between.high}, middle, before, best);
  }

  const Pair& pair_;
  TileCost cost_;
  std::array<std::size_t, 2> start_;
  const Blame* blame_;
  std::size_t m_, n_;
  std::size_t reached_count_ = 0;        ///< nodes of the last search
  std::size_t failed_count_ = 0;         ///< nodes of failed searches since the last search without a limit
  std::vector<Sum> to_row_, to_column_;  ///< least sums of steps from the first row and column to each;
                                         ///< empty: not used
  std::vector<float> to_end_;            ///< least cost from each node to the last row; empty: not used
};

/// The number of pairs of points whose tables take about 1 GB. least_angle takes two bytes per pair: one for
/// the path and one for the span's score. Paths from all starts take at most 14 bytes.
std::size_t most_pairs(TileCost cost) {
  return std::size_t{1} << (cost == TileCost::least_angle ? 29 : 26);
}

void check(const Ring& lower, const Ring& upper, TileCost cost) {
  for (const Ring* ring : {&lower, &upper})
    if (ring->points_mm.size() < 3)
      throw std::invalid_argument("tile: a ring has " + std::to_string(ring->points_mm.size()) +
                                  " points, three are needed");
  if (!(lower.z_mm < upper.z_mm))
    throw std::invalid_argument("tile: the lower ring must lie below the upper one");
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

/// The best strip: for costs of single triangles among all starts, for others from the given start. `blame`
/// may be null.
std::vector<std::array<std::uint32_t, 3>> best_strip(const Ring& lower, const Ring& upper, TileCost cost,
                                                     const std::array<std::size_t, 2>& start,
                                                     const Blame* blame) {
  const std::vector<Step> greedy = greedy_steps(lower, upper, start, blame);
  const Pair pair{turned(lower, start[0]), turned(upper, start[1])};
  LeastPath paths(pair, cost, start, blame);
  const bool any_start = cost == TileCost::least_area || cost == TileCost::greatest_volume;
  const Found found = any_start ? paths.find(greedy) : paths.find_from_start(greedy);
  const std::size_t m = lower.points_mm.size(), n = upper.points_mm.size();
  const std::array<std::size_t, 2> from{start[0], (start[1] + found.start) % n};
  if (blame == nullptr || cost == TileCost::least_angle) return faces_of(lower, upper, from, found.steps);
  const auto neck = neck_of(path_of(found.steps, 0), n);
  if (!neck) return faces_of(lower, upper, from, found.steps);
  const std::array<std::size_t, 2> at{(from[0] + (*neck)[0]) % m, (from[1] + (*neck)[1]) % n};
  const Pair of_neck{turned(lower, at[0]), turned(upper, at[1])};
  return faces_of(lower, upper, at, LeastPath(of_neck, cost, at, blame).surface_steps());
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> tile(const Ring& lower, const Ring& upper, TileCost cost) {
  check(lower, upper, cost);
  const std::array<std::size_t, 2> start = start_of(lower, upper);
  if (cost == TileCost::shortest_span)
    return faces_of(lower, upper, start, greedy_steps(lower, upper, start));
  return best_strip(lower, upper, cost, start, nullptr);
}

namespace {

/// The best strip by the blame of two rings, which may have been scaled.
std::vector<std::array<std::uint32_t, 3>> blamed_strip(const Ring& lower, const Ring& upper, TileCost cost,
                                                       const Blame& blame, bool has_avoided) {
  const std::array<std::size_t, 2> start = start_of(lower, upper, &blame);
  const bool has_room = lower.points_mm.size() * upper.points_mm.size() <= most_pairs(TileCost::least_area);
  if (cost == TileCost::shortest_span && (!has_avoided || !has_room))
    return faces_of(lower, upper, start, greedy_steps(lower, upper, start, &blame));
  return best_strip(lower, upper, cost, start, &blame);
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> tile_clear(
    const Ring& lower, const Ring& upper, TileCost cost, const SpanClearance& sides,
    std::vector<std::uint8_t>& scores, const std::vector<std::array<std::uint32_t, 3>>& avoided) {
  check(lower, upper, cost);
  const Blame blame(lower, upper, ScoreInPlane(lower, upper, sides), avoided, scores);
  return blamed_strip(lower, upper, cost, blame, !avoided.empty());
}

std::vector<std::array<std::uint32_t, 3>> tile_clear_aligned(
    const Ring& lower, const Ring& upper, TileCost cost, std::vector<std::uint8_t>& scores,
    const std::vector<std::array<std::uint32_t, 3>>& avoided) {
  check(lower, upper, cost);
  const Ring above{in_box(upper.points_mm, box_of(lower.points_mm)), upper.z_mm};
  const SpanClearance sides({{lower.points_mm}}, {{above.points_mm}});
  const Blame blame(lower, above, ScoreInPlane(lower, above, sides), avoided, scores);
  return blamed_strip(lower, upper, cost, blame, !avoided.empty());
}

std::vector<std::array<std::uint32_t, 3>> tile_apart(
    const Ring& lower, const Ring& upper, const SurfaceClearance& others,
    const std::vector<std::array<std::uint32_t, 3>>& avoided) {
  check(lower, upper, TileCost::shortest_span);
  const auto score = [&](std::size_t i, std::size_t j) {
    return others.crossed({lower.points_mm[i], lower.z_mm}, {upper.points_mm[j], upper.z_mm}, most_crossed);
  };
  std::vector<std::uint8_t> scores;
  const Blame blame(lower, upper, score, avoided, scores);
  return blamed_strip(lower, upper, TileCost::shortest_span, blame, !avoided.empty());
}

std::vector<std::array<std::uint32_t, 3>> tile_near(const Ring& lower, const Ring& upper, TileCost cost,
                                                    std::size_t band) {
  check(lower, upper, cost);
  const std::array<std::size_t, 2> start = start_of(lower, upper);
  const std::vector<Step> shortest = greedy_steps(lower, upper, start);
  if (cost == TileCost::shortest_span || band == 0) return faces_of(lower, upper, start, shortest);
  const Pair pair{turned(lower, start[0]), turned(upper, start[1])};
  return faces_of(lower, upper, start, LeastPath(pair, cost, start).find_in(about(shortest, band)).steps);
}

std::vector<std::array<std::uint32_t, 3>> tile_about(const Ring& lower, const Ring& upper, TileCost cost,
                                                     std::size_t band,
                                                     const std::vector<std::array<std::uint32_t, 3>>& strip) {
  check(lower, upper, cost);
  const std::size_t m = lower.points_mm.size();
  if (strip.size() != m + upper.points_mm.size())
    throw std::invalid_argument("tile_about: the strip is none of these rings");
  const auto is_along_upper = [&](const std::array<std::uint32_t, 3>& face) { return face[2] < m; };
  const auto& first = strip.front();
  const std::array<std::size_t, 2> start = is_along_upper(first)
                                               ? std::array<std::size_t, 2>{first[2], first[1] - m}
                                               : std::array<std::size_t, 2>{first[0], first[2] - m};
  std::vector<Step> steps;
  for (const auto& face : strip) steps.push_back(is_along_upper(face) ? along_upper : along_lower);
  const Pair pair{turned(lower, start[0]), turned(upper, start[1])};
  return faces_of(lower, upper, start, LeastPath(pair, cost, start).find_in(about(steps, band)).steps);
}

}  // namespace octotomy::brep
