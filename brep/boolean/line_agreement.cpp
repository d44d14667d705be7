// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 choose a line along x through each of the given triangles; 2 list all crossings of lines and triangles in
// one pass; 3 follow each line: the intervals inside a result must be those that the operation makes from the
// intervals inside the operands; 4 check a line that disagrees with two further lines through the same
// triangle. Most triangles lie between two lines; they are skipped by comparing the y intervals of their
// points, two bytes each. Where there are many lines, those of a y interval are searched by z.
#include "brep/boolean/line_agreement.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>
#include <tbb/parallel_for.h>
#include <tuple>
#include <vector>

#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/row_crossing.h"
#include "brep/mesh/short_text.h"

namespace octotomy::brep {
namespace {

/// The operands, followed by the results; absent ones are null.
using Surfaces = std::array<const Triangles*, 6>;
constexpr std::size_t operand_count = 2;

/// The largest coordinate, which determines the last place of the points.
double reach_mm(const Solid& a, const Solid& b) {
  glm::dvec3 reach(0.0);
  for (const Size* size : {&a.size(), &b.size()})
    reach = glm::max(reach, glm::max(glm::abs(size->low_mm), glm::abs(size->high_mm)));
  return std::max({reach.x, reach.y, reach.z});
}

/// The length over which a line may disagree: 2^20 units of the last place, 0.06 nm for a head. Points are
/// rounded by less than one unit. On a side at an angle of 2^-16 to the line, that shifts the crossing by up
/// to 2^16 units.
double tolerance_mm(double reach) {
  return 0x1p20 * std::numeric_limits<double>::epsilon() * reach;
}

/// Smallest height of a triangle, projected along x, at which a line through point_in() is sure to avoid the
/// triangle's sides.
double clearance_mm(double reach) {
  return 0x1p12 * std::numeric_limits<double>::epsilon() * reach;
}

struct Line {
  glm::dvec3 at_mm;
  Corners triangle;
  double length_mm = 0.0;  ///< length over which the line disagrees
  std::size_t result = operand_count;
};

/// A point inside the triangle, a different one in each round. Its barycentric coordinates are not simple
/// fractions, so sides of neighbours and of the other surface's triangles are unlikely to pass through it.
glm::dvec3 point_in(const Corners& t, std::size_t round) {
  constexpr std::array<glm::dvec2, 3> shares = {{{0.41592, 0.30901}, {0.23606, 0.44721}, {0.28171, 0.17157}}};
  return t[0] + shares.at(round).x * (t[1] - t[0]) + shares.at(round).y * (t[2] - t[0]);
}

/// One line through each triangle that is high enough to avoid its sides.
std::vector<Line> lines_through(const std::vector<Corners>& triangles, double clearance) {
  std::vector<Line> lines;
  for (const Corners& t : triangles) {
    double longest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 side = t[(k + 1) % 3] - t[k];
      longest = std::max(longest, std::hypot(side.y, side.z));
    }
    if (2.0 * shadow_mm2(t) > clearance * longest) lines.push_back({point_in(t, 0), t});
  }
  return lines;
}

/// A crossing of a line with a surface.
struct Crossing {
  std::uint32_t line;
  std::uint8_t surface;
  std::int8_t enters;  ///< 1 or -1
  double x;
};

/// The lines, sorted by intervals of y and, within an interval, by z. Points are assigned to the same
/// intervals.
class LinesByPlace {
 public:
  explicit LinesByPlace(const std::vector<Line>& lines) : before_(stretch_count + 1, 0) {
    assert(!lines.empty());
    const auto [least, greatest] = std::minmax_element(
        lines.begin(), lines.end(), [](const Line& p, const Line& q) { return p.at_mm.y < q.at_mm.y; });
    low_ = least->at_mm.y;
    const double extent = greatest->at_mm.y - low_;
    scale_ = extent > 0.0 ? static_cast<double>(stretch_count - 3) / extent : 0.0;
    for (std::uint32_t i = 0; i < lines.size(); ++i) {
      ++before_[stretch(lines[i].at_mm.y) + 1u];
      ordered_.push_back({stretch(lines[i].at_mm.y), lines[i].at_mm.z, i});
    }
    for (std::size_t s = 0; s < stretch_count; ++s) before_[s + 1] += before_[s];
    std::sort(ordered_.begin(), ordered_.end());
  }

  /// The number of the interval that holds y. Numbers ascend with y; no line lies in the first and the last
  /// interval.
  std::uint16_t stretch(double y) const {
    constexpr auto last = static_cast<double>(stretch_count - 1);
    return static_cast<std::uint16_t>(std::clamp(1.0 + (y - low_) * scale_, 0.0, last));
  }

  /// Calls visit(line) for the lines of the intervals from `least` to `greatest`. If these are more than a
  /// few lines, leaves out those outside z_range().
  template <typename Range, typename Visit>
  void visit(std::uint16_t least, std::uint16_t greatest, const Range& z_range, const Visit& visit) const {
    constexpr std::uint32_t few = 16;
    const std::uint32_t end = before_[greatest + 1u];
    if (end - before_[least] <= few) {
      for (std::uint32_t i = before_[least]; i < end; ++i) visit(ordered_[i].line);
      return;
    }
    const auto [low, high] = z_range();
    for (std::uint32_t s = least; s <= greatest; ++s) {
      const auto last = ordered_.begin() + before_[s + 1u];
      for (auto at = std::lower_bound(ordered_.begin() + before_[s], last, low,
                                      [](const Entry&entry, double z) { return entry.z < z; });
           at != last && at->z <= high; ++at)
        visit(at->line);
    }
  }

 private:
  static constexpr std::size_t stretch_count = 1 << 11;
  struct Entry {
    std::uint16_t stretch;
    double z;
    std::uint32_t line;
    auto operator<=>(const Entry&) const = default;
  };
  std::vector<Entry> ordered_;
  std::vector<std::uint32_t> before_;  ///< for each interval: the number of lines in earlier ones
  double low_ = 0.0, scale_ = 0.0;
};

std::vector<Crossing> crossings(const Triangles& surface, std::uint8_t number, const std::vector<Line>& lines,
                                const LinesByPlace& by_place) {
  std::vector<std::uint16_t> stretches(surface.points_mm.size());
  for (std::size_t v = 0; v < stretches.size(); ++v) stretches[v] = by_place.stretch(surface.points_mm[v].y);
  std::vector<Crossing> found;
  for (const auto& face : surface.faces) {
    const std::uint16_t p = stretches[face[0]], q = stretches[face[1]], r = stretches[face[2]];
    const auto corner = [&](std::size_t k) { return surface.points_mm[face[k]]; };
    const auto z_range = [&] { return std::minmax({corner(0).z, corner(1).z, corner(2).z}); };
    by_place.visit(
        std::min(std::min(p, q), r), std::max(std::max(p, q), r), z_range, [&](std::uint32_t line) {
          const glm::dvec3& at_mm = lines[line].at_mm;
          if (const auto crossing = row_crossing({corner(0), corner(1), corner(2)}, at_mm.z);
              crossing && crossing->has(at_mm.y))
            found.push_back(
                {line, number, static_cast<std::int8_t>(crossing->enters), crossing->x_at(at_mm.y)});
        });
  }
  return found;
}

bool is_in_result(std::size_t place, bool in_a, bool in_b) {
  return place == of_union          ? in_a || in_b
         : place == of_intersection ? in_a && in_b
         : place == of_a_minus_b    ? in_a && !in_b
                                    : in_b && !in_a;
}

/// Computes the worst disagreement of a line from its crossings begin..end - 1, in order of x.
void follow(const Surfaces& surfaces, const Crossing* begin, const Crossing* end, Line& line) {
  std::array<int, 6> winding{};
  std::array<double, 6> wrong_mm{};
  for (const Crossing* at = begin; at + 1 < end; ++at) {
    winding[at->surface] += at->enters;
    for (std::size_t s = operand_count; s < surfaces.size(); ++s)
      if (surfaces[s] && is_in_result(s - operand_count, winding[0] > 0, winding[1] > 0) != (winding[s] > 0))
        wrong_mm[s] += (at + 1)->x - at->x;
  }
  line.result = static_cast<std::size_t>(std::max_element(wrong_mm.begin() + operand_count, wrong_mm.end()) -
                                         wrong_mm.begin());
  line.length_mm = wrong_mm[line.result];
}

void follow_all(const Surfaces& surfaces, std::vector<Line>& lines) {
  if (lines.empty()) return;
  const LinesByPlace by_place(lines);
  std::array<std::vector<Crossing>, 6> found;
  tbb::parallel_for(std::size_t{0}, surfaces.size(), [&](std::size_t s) {
    if (surfaces[s]) found[s] = crossings(*surfaces[s], static_cast<std::uint8_t>(s), lines, by_place);
  });
  std::vector<Crossing> all;
  for (const std::vector<Crossing>& of_surface : found)
    all.insert(all.end(), of_surface.begin(), of_surface.end());
  std::sort(all.begin(), all.end(), [](const Crossing& p, const Crossing& q) {
    return std::tie(p.line, p.x, p.surface, p.enters) < std::tie(q.line, q.x, q.surface, q.enters);
  });
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && all[end].line == all[begin].line) ++end;
    follow(surfaces, all.data() + begin, all.data() + end, lines[all[begin].line]);
  }
}

}  // namespace

Corners corners(const Triangles& surface, std::size_t f) {
  const auto& face = surface.faces[f];
  return {surface.points_mm[face[0]], surface.points_mm[face[1]], surface.points_mm[face[2]]};
}

std::vector<Corners> widest_triangles(const Triangles& surface) {
  constexpr std::size_t spread_count = 16;
  DisjointSets sets(surface.points_mm.size());
  for (const auto& face : surface.faces) {
    sets.join(face[0], face[1]);
    sets.join(face[1], face[2]);
  }
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  struct Widest {
    double mm2 = -1.0;
    std::uint32_t face = none;
  };
  std::vector<Widest> widest(surface.points_mm.size());
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f) {
    Widest& of_shell = widest[sets.set_of(surface.faces[f][0])];
    const double mm2 = shadow_mm2(corners(surface, f));
    if (mm2 > of_shell.mm2) of_shell = {mm2, f};
  }
  std::vector<Corners> through;
  for (const Widest& shell : widest)
    if (shell.face != none) through.push_back(corners(surface, shell.face));
  for (std::size_t k = 0; k < std::min(spread_count, surface.faces.size()); ++k)
    through.push_back(corners(surface, surface.faces.size() * k / spread_count));
  return through;
}

std::optional<LineDisagreement> disagreement_along_lines(const Solid& a, const Solid& b,
                                                         const Results& results, const Wanted& wanted,
                                                         const std::vector<Corners>& through) {
  Surfaces surfaces{&a.triangles(), &b.triangles()};
  for (std::size_t r = 0; r < results.size(); ++r)
    if (wanted[r] && results[r]) surfaces[operand_count + r] = &*results[r];
  const double reach = reach_mm(a, b), tolerance = tolerance_mm(reach);
  std::vector<Line> lines = lines_through(through, clearance_mm(reach));
  constexpr std::size_t rounds = 3;
  for (std::size_t round = 0; round < rounds; ++round) {
    for (Line& line : lines) line.at_mm = point_in(line.triangle, round);
    follow_all(surfaces, lines);
    std::erase_if(lines, [&](const Line& line) { return line.length_mm <= tolerance; });
  }
  if (lines.empty()) return std::nullopt;
  const Line& worst = *std::max_element(
      lines.begin(), lines.end(), [](const Line& p, const Line& q) { return p.length_mm < q.length_mm; });
  return LineDisagreement{static_cast<ResultPlace>(worst.result - operand_count), worst.at_mm,
                          worst.length_mm};
}

std::optional<LineDisagreement> disagreement_along_lines(const Solid& a, const Solid& b,
                                                         const Results& results, const Wanted& wanted) {
  std::vector<Corners> through = widest_triangles(a.triangles());
  const auto add = [&](const std::vector<Corners>& more) {
    through.insert(through.end(), more.begin(), more.end());
  };
  add(widest_triangles(b.triangles()));
  for (std::size_t r = 0; r < results.size(); ++r)
    if (wanted[r] && results[r]) add(widest_triangles(*results[r]));
  return disagreement_along_lines(a, b, results, wanted, through);
}

std::string text_of(const LineDisagreement& wrong) {
  return " would be wrong along " + short_text(wrong.length_mm) + " mm of the line along x through (" +
         short_text(wrong.at_mm.x) + ", " + short_text(wrong.at_mm.y) + ", " + short_text(wrong.at_mm.z) +
         ") mm";
}

}  // namespace octotomy::brep
