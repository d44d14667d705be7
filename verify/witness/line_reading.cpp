// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Windows: a line is followed through the scan from cell to cell. In a cell the interpolant along the line is a
// cubic, whose crossings of the window's bounds are computed to rounding. So no layer is too thin to be found.
// Bricks of 4 cells a side whose samples all lie inside or all outside the window are passed in one step. Where a
// line crosses the planes between cells is computed from the line and the plane alone, and each cubic spans the
// line's whole way through its cell. So the ends of a span do not depend on which part of the line is read, and
// an object minus itself is empty.
#include "verify/witness/line_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>
#include <variant>

#include "verify/witness/cell_cubic.h"
#include "verify/witness/postfix.h"

namespace octotomy::verify {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const voxel::Box everywhere{glm::dvec3(-infinity), glm::dvec3(infinity)};

/// Appends a span, or extends the last span if the two touch. Precondition: the new span begins no sooner
/// than the last one.
void append(Spans& spans, double low_mm, double high_mm) {
  if (!(high_mm > low_mm)) return;
  constexpr double touching_mm = 1e-9;
  if (!spans.empty() && low_mm <= spans.back().high_mm + touching_mm)
    spans.back().high_mm = std::max(spans.back().high_mm, high_mm);
  else
    spans.push_back({low_mm, high_mm});
}

/// Returns the parts of `within` between two positions on the line.
Spans clipped(const Spans& within, double low_mm, double high_mm) {
  Spans made;
  for (const Span& span : within)
    append(made, std::max(span.low_mm, low_mm), std::min(span.high_mm, high_mm));
  return made;
}

Spans less(const Spans& whole, const Spans& part) {
  Spans made;
  auto next = part.begin();
  for (const Span& span : whole) {
    double at_mm = span.low_mm;
    while (next != part.end() && next->high_mm <= at_mm) ++next;
    for (auto cut = next; cut != part.end() && cut->low_mm < span.high_mm; ++cut) {
      append(made, at_mm, std::min(cut->low_mm, span.high_mm));
      at_mm = std::max(at_mm, cut->high_mm);
    }
    append(made, at_mm, span.high_mm);
  }
  return made;
}

Spans joined(const Spans& a, const Spans& b) {
  Spans all = a;
  all.insert(all.end(), b.begin(), b.end());
  std::sort(all.begin(), all.end(), [](const Span& x, const Span& y) { return x.low_mm < y.low_mm; });
  Spans made;
  for (const Span& span : all) append(made, span.low_mm, span.high_mm);
  return made;
}

/// Returns start and end of the part of a line on the inner side of all planes. Start exceeds end if there is
/// no such part.
template <typename Sides>
std::pair<double, double> between(const Line& line, const Sides& sides) {
  double low_mm = -infinity, high_mm = infinity;
  for (const HalfSpace& side : sides) {
    const double slope = glm::dot(side.normal, line.along);
    const double room_mm = side.offset_mm - glm::dot(side.normal, line.from_mm);
    if (slope > 0.0)
      high_mm = std::min(high_mm, room_mm / slope);
    else if (slope < 0.0)
      low_mm = std::max(low_mm, room_mm / slope);
    else if (room_mm < 0.0)
      return {infinity, -infinity};
  }
  return {low_mm, high_mm};
}

std::array<HalfSpace, 6> sides_of(const voxel::Box& box) {
  std::array<HalfSpace, 6> sides;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 normal(0.0);
    normal[axis] = 1.0;
    sides[2 * static_cast<std::size_t>(axis)] = {normal, box.high_mm[axis]};
    sides[2 * static_cast<std::size_t>(axis) + 1] = {-normal, -box.low_mm[axis]};
  }
  return sides;
}

bool overlap(const voxel::Box& a, const voxel::Box& b) {
  return glm::all(glm::lessThanEqual(a.low_mm, b.high_mm)) &&
         glm::all(glm::lessThanEqual(b.low_mm, a.high_mm));
}

voxel::Box moved_box(const voxel::Box& box, const glm::dmat4& by) {
  voxel::Box made{glm::dvec3(by[3]), glm::dvec3(by[3])};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const double share = by[column][row];
      if (share == 0.0) continue;  // zero times an infinite side is NaN
      const double a = share * box.low_mm[column], b = share * box.high_mm[column];
      made.low_mm[row] += std::min(a, b);
      made.high_mm[row] += std::max(a, b);
    }
  return made;
}

/// Computes the parts of lines on which a scan's interpolant lies in a window.
template <typename Sample>
class WindowAlong {
 public:
  WindowAlong(std::shared_ptr<const voxel::Scene> scan, double low, double high)
      : scan_(std::move(scan)),
        samples_(std::get<voxel::Samples<Sample>>(scan_->samples).data()),
        dims_(scan_->lattice.dims),
        low_(low),
        high_(high),
        scan_from_lps_(glm::inverse(scan_->lattice.lps_from_voxel)) {
    for (int axis = 0; axis < 3; ++axis) bricks_[axis] = std::max(1, (dims_[axis] - 1 + brick - 1) / brick);
    states_.resize(static_cast<std::size_t>(bricks_.x) * static_cast<std::size_t>(bricks_.y) *
                   static_cast<std::size_t>(bricks_.z));
    tbb::parallel_for(0, bricks_.z, [this](int z) { set_states(z); });
  }

  Spans operator()(const Line& line, const Spans& within) const {
    const glm::dvec3 u0(scan_from_lps_ * glm::dvec4(line.from_mm, 1.0));
    const glm::dvec3 du = glm::dmat3(scan_from_lps_) * line.along;
    std::array<HalfSpace, 6> ends = sides_of({glm::dvec3(-0.5), glm::dvec3(dims_) - 0.5});
    const auto [low_mm, high_mm] = between({u0, du}, ends);
    Spans inside;
    for (const Span& span : clipped(within, low_mm, high_mm))
      follow({u0, du, {low_mm, high_mm}}, span, inside);
    return inside;
  }

  bool may_meet(const voxel::Box& box) const {
    const voxel::Box cells = moved_box(box, scan_from_lps_);
    for (int axis = 0; axis < 3; ++axis)
      if (cells.high_mm[axis] < -0.5 || cells.low_mm[axis] > dims_[axis] - 0.5) return false;
    const glm::ivec3 first = brick_of(cells.low_mm), last = brick_of(cells.high_mm);
    for (int z = first.z; z <= last.z; ++z)
      for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x)
          if (states_[index_of({x, y, z})] != State::Out) return true;
    return false;
  }

 private:
  enum class State : std::uint8_t { Out, In, Mixed };
  static constexpr int brick = 4;  ///< cells a side

  std::size_t index_of(const glm::ivec3& b) const {
    return static_cast<std::size_t>(b.x) +
           static_cast<std::size_t>(bricks_.x) *
               (static_cast<std::size_t>(b.y) +
                static_cast<std::size_t>(bricks_.y) * static_cast<std::size_t>(b.z));
  }
  const Sample* sample(int x, int y, int z) const {
    return samples_ + static_cast<std::size_t>(x) +
           static_cast<std::size_t>(dims_.x) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(z));
  }

  /// The range of the samples of a brick, with the first samples of the bricks after it.
  struct Range {
    Sample least = std::numeric_limits<Sample>::max(), most = std::numeric_limits<Sample>::lowest();
    bool is_finite = true;

    void add(const Range& other) {
      least = std::min(least, other.least);
      most = std::max(most, other.most);
      is_finite = is_finite && other.is_finite;
    }
  };

  /// Computes the states of one layer of bricks.
  void set_states(int z) {
    std::vector<Range> layer(static_cast<std::size_t>(bricks_.x) * static_cast<std::size_t>(bricks_.y));
    for (int slice = z * brick; slice <= std::min((z + 1) * brick, dims_.z - 1); ++slice)
      for (int y = 0; y < dims_.y; ++y) {
        const Sample* row = sample(0, y, slice);
        const int last = std::min(y / brick, bricks_.y - 1),
                  first = y % brick == 0 ? std::max(y / brick - 1, 0) : last;
        for (int x = 0; x < bricks_.x; ++x) {
          const Range range = range_of(row + x * brick, row + std::min((x + 1) * brick, dims_.x - 1));
          for (int b = std::min(first, last); b <= last; ++b) layer[index_of({x, b, 0})].add(range);
        }
      }
    for (int y = 0; y < bricks_.y; ++y)
      for (int x = 0; x < bricks_.x; ++x) states_[index_of({x, y, z})] = state_of(layer[index_of({x, y, 0})]);
  }

  static Range range_of(const Sample* first, const Sample* last) {
    Range range{*first, *first};
    for (const Sample* at = first; at <= last; ++at) {
      range.least = std::min(range.least, *at);
      range.most = std::max(range.most, *at);
      if constexpr (std::is_floating_point_v<Sample>) range.is_finite = range.is_finite && std::isfinite(*at);
    }
    return range;
  }

  State state_of(const Range& range) const {
    const auto least = static_cast<double>(range.least), most = static_cast<double>(range.most);
    if (!range.is_finite || (scan_->padding && least == *scan_->padding && most >= low_)) return State::Mixed;
    return most < low_ || least > high_     ? State::Out
           : least >= low_ && most <= high_ ? State::In
                                            : State::Mixed;
  }

  glm::ivec3 brick_of(const glm::dvec3& u) const {
    glm::ivec3 b;
    for (int axis = 0; axis < 3; ++axis)
      b[axis] = std::clamp(static_cast<int>(std::clamp(u[axis], 0.0, dims_[axis] - 1.0)) / brick, 0,
                           bricks_[axis] - 1);
    return b;
  }

  /// A line in units of samples: u0 + at_mm * du.
  struct Course {
    glm::dvec3 u0, du;
    Span ends_mm;  ///< the part of the line that is read: up to half a sample beyond the outermost samples

    /// The position at which the line crosses a plane of samples perpendicular to an axis.
    double crosses_mm(int axis, int plane) const { return (plane - u0[axis]) / du[axis]; }
  };

  /// The number, along an axis, of the cell at a position: -1 before the first sample, and dims - 1 behind
  /// the last one. A plane between two cells belongs to the cell that the line enters there.
  int cell_at(const Course& course, int axis, double at_mm) const {
    const int most = dims_[axis] - 1;
    const double u = std::clamp(course.u0[axis] + at_mm * course.du[axis], -1.0, most + 0.5);
    int cell = static_cast<int>(std::floor(u));
    // `u` is rounded differently from the crossings of planes, so the cell is corrected until it agrees with
    // them.
    if (course.du[axis] > 0.0) {
      while (cell < most && course.crosses_mm(axis, cell + 1) <= at_mm) ++cell;
      while (cell >= 0 && course.crosses_mm(axis, cell) > at_mm) --cell;
    } else if (course.du[axis] < 0.0) {
      while (cell >= 0 && course.crosses_mm(axis, cell) <= at_mm) --cell;
      while (cell < most && course.crosses_mm(axis, cell + 1) > at_mm) ++cell;
    }
    return cell;
  }

  /// Returns the positions at which the line enters and leaves the layer of cells with this number along an
  /// axis. The first and the last layer extend beyond the samples without end.
  Span passes_mm(const Course& course, int axis, int cell) const {
    if (course.du[axis] == 0.0) return {-infinity, infinity};
    Span passed{cell < 0 ? -infinity : course.crosses_mm(axis, cell),
                cell + 1 >= dims_[axis] ? infinity : course.crosses_mm(axis, cell + 1)};
    if (course.du[axis] < 0.0)
      passed = {cell + 1 >= dims_[axis] ? -infinity : passed.high_mm, cell < 0 ? infinity : passed.low_mm};
    return passed;
  }

  glm::ivec3 brick_of(const glm::ivec3& cell) const {
    return glm::clamp(glm::max(cell, 0) / brick, glm::ivec3(0), bricks_ - 1);
  }

  /// The position at which a line leaves a brick. The outermost bricks extend beyond the samples without end.
  double leaves_mm(const Course& course, const glm::ivec3& b) const {
    double at_mm = infinity;
    for (int axis = 0; axis < 3; ++axis) {
      if (course.du[axis] > 0.0 && b[axis] + 1 < bricks_[axis])
        at_mm = std::min(at_mm, course.crosses_mm(axis, (b[axis] + 1) * brick));
      if (course.du[axis] < 0.0 && b[axis] > 0)
        at_mm = std::min(at_mm, course.crosses_mm(axis, b[axis] * brick));
    }
    return at_mm;
  }

  bool is_padding(double value) const { return scan_->padding && value == *scan_->padding; }

  /// A line's way through a cell: the positions of its ends on the line, and its end points in shares of the
  /// cell's edges.
  struct Way {
    Span ends_mm;
    glm::dvec3 from, to;

    void add(const Share& share, const Span& part, Spans& inside) const {
      const auto at_mm = [this](double s) {
        return s == 1.0 ? ends_mm.high_mm : ends_mm.low_mm + s * (ends_mm.high_mm - ends_mm.low_mm);
      };
      append(inside, std::max(at_mm(share.low), part.low_mm), std::min(at_mm(share.high), part.high_mm));
    }
  };

  /// In a cell with padding there is no interpolation. The nearest sample's value counts; padding is outside.
  void add_nearest(const CellCorners& corners, const Way& way, const Span& part, Spans& inside) const {
    std::array<double, 5> ends{0.0, 1.0, 1.0, 1.0, 1.0};
    for (int axis = 0; axis < 3; ++axis) {
      const double middle = (0.5 - way.from[axis]) / (way.to[axis] - way.from[axis]);
      if (middle > 0.0 && middle < 1.0) ends[static_cast<std::size_t>(axis) + 1] = middle;
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const glm::dvec3 at = glm::mix(way.from, way.to, 0.5 * (ends[i] + ends[i + 1]));
      const double value = corners[(at.x < 0.5 ? 0U : 1U) + (at.y < 0.5 ? 0U : 2U) + (at.z < 0.5 ? 0U : 4U)];
      if (std::isfinite(value) && !is_padding(value) && value >= low_ && value <= high_)
        way.add({ends[i], ends[i + 1]}, part, inside);
    }
  }

  /// Adds to `inside` the stretch of a line, within a cell and within `part`, on which values are in the
  /// window.
  void add_cell(const Course& course, const glm::ivec3& cell, const Span& ends_mm, const Span& part,
                Spans& inside) const {
    const glm::ivec3 first = glm::clamp(cell, glm::ivec3(0), glm::max(dims_ - 2, 0)),
                     next = glm::min(first + 1, dims_ - 1);
    CellCorners corners;
    const auto x = static_cast<std::size_t>(next.x - first.x);
    std::size_t i = 0;
    for (const int z : {first.z, next.z})
      for (const int y : {first.y, next.y}) {
        const Sample* at = sample(first.x, y, z);
        corners[i++] = static_cast<double>(at[0]);
        corners[i++] = static_cast<double>(at[x]);
      }
    const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
    const bool has_padding =
        scan_->padding && std::find(corners.begin(), corners.end(), *scan_->padding) != corners.end();
    if (!has_padding) {
      if constexpr (std::is_floating_point_v<Sample>)
        if (!std::all_of(corners.begin(), corners.end(), [](double c) { return std::isfinite(c); })) return;
      if (*most < low_ || *least > high_) return;
      if (*least >= low_ && *most <= high_) {
        append(inside, std::max(ends_mm.low_mm, part.low_mm), std::min(ends_mm.high_mm, part.high_mm));
        return;
      }
    }
    // Beyond the outermost samples the interpolant has the value at the nearest point within them.
    const glm::dvec3 origin(first);
    const Way way{ends_mm, glm::clamp(course.u0 + ends_mm.low_mm * course.du - origin, 0.0, 1.0),
                  glm::clamp(course.u0 + ends_mm.high_mm * course.du - origin, 0.0, 1.0)};
    if (has_padding) return add_nearest(corners, way, part, inside);
    for (const Share& share : shares_within(cubic_along(corners, way.from, way.to), low_, high_))
      way.add(share, part, inside);
  }

  /// Reads, cell by cell, a part of a line that lies in one brick.
  void follow_cells(const Course& course, glm::ivec3 cell, const Span& part, Spans& inside) const {
    std::array<Span, 3> passed;
    for (int axis = 0; axis < 3; ++axis)
      passed[static_cast<std::size_t>(axis)] = passes_mm(course, axis, cell[axis]);
    for (;;) {
      const Span ends_mm{
          std::max({passed[0].low_mm, passed[1].low_mm, passed[2].low_mm, course.ends_mm.low_mm}),
          std::min({passed[0].high_mm, passed[1].high_mm, passed[2].high_mm, course.ends_mm.high_mm})};
      add_cell(course, cell, ends_mm, part, inside);
      if (ends_mm.high_mm >= part.high_mm) return;
      for (int axis = 0; axis < 3; ++axis) {
        Span& along = passed[static_cast<std::size_t>(axis)];
        while (along.high_mm <= ends_mm.high_mm) {
          cell[axis] += course.du[axis] > 0.0 ? 1 : -1;
          along = passes_mm(course, axis, cell[axis]);
        }
      }
    }
  }

  void follow(const Course& course, const Span& span, Spans& inside) const {
    for (double at_mm = span.low_mm; at_mm < span.high_mm;) {
      glm::ivec3 cell;
      for (int axis = 0; axis < 3; ++axis) cell[axis] = cell_at(course, axis, at_mm);
      const glm::ivec3 b = brick_of(cell);
      const double out_mm = std::min(leaves_mm(course, b), span.high_mm);
      const State state = states_[index_of(b)];
      if (state == State::In) append(inside, at_mm, out_mm);
      if (state == State::Mixed) follow_cells(course, cell, {at_mm, out_mm}, inside);
      at_mm = out_mm;
    }
  }

  std::shared_ptr<const voxel::Scene> scan_;
  const Sample* samples_;
  glm::ivec3 dims_, bricks_{1};
  double low_, high_;
  glm::dmat4 scan_from_lps_;
  std::vector<State> states_;  ///< of bricks, x fastest
};

template <typename Sample>
LineReading window_reading(std::shared_ptr<const voxel::Scene> scan, double low, double high) {
  const voxel::Box box = voxel::bounds(scan->lattice);
  const auto window = std::make_shared<const WindowAlong<Sample>>(std::move(scan), low, high);
  return {[window](const Line& line, const Spans& within) { return (*window)(line, within); },
          [window](const voxel::Box& part) { return window->may_meet(part); }, box, 100.0};
}

/// The largest cost of an expression with a reading, equal to that of two hundred windows. A costlier
/// expression has none, for instance one whose size is doubled repeatedly by steps of the plan. Reading one
/// line of it would take seconds, and the recursion would be as deep as it has operands.
constexpr double most_cost = 2e4;

/// Reads the cheaper operand first, and the other one only where the answer still depends on it.
LineReading intersection(LineReading a, LineReading b) {
  if (!a || !b) return {};
  if (b.cost < a.cost) std::swap(a, b);
  const voxel::Box box{glm::max(a.box_mm.low_mm, b.box_mm.low_mm),
                       glm::min(a.box_mm.high_mm, b.box_mm.high_mm)};
  const double cost = a.cost + b.cost;
  if (cost > most_cost) return {};
  return {[a = std::move(a.inside), b = std::move(b.inside)](const Line& line, const Spans& within) {
            const Spans of_a = a(line, within);
            return of_a.empty() ? of_a : b(line, of_a);
          },
          [a = std::move(a.may_meet), b = std::move(b.may_meet)](const voxel::Box& part) {
            return a(part) && b(part);
          },
          box, cost};
}

LineReading complement(LineReading a) {
  if (!a || a.cost > most_cost) return {};
  return {[a = std::move(a.inside)](const Line& line, const Spans& within) {
            return less(within, a(line, within));
          },
          [](const voxel::Box&) { return true; }, everywhere, a.cost + 10.0};
}

}  // namespace

LineReading lines_in_window(std::shared_ptr<const voxel::Scene> scan, double low, double high) {
  if (std::holds_alternative<voxel::Int16Samples>(scan->samples))
    return window_reading<std::int16_t>(std::move(scan), low, high);
  return window_reading<float>(std::move(scan), low, high);
}

LineReading lines_in_region(const glm::dvec3& right, const glm::dvec3& up,
                            const std::vector<std::vector<glm::dvec2>>& polygons_mm) {
  std::vector<std::array<glm::dvec2, 2>> edges;
  voxel::Box box = everywhere;
  glm::dvec2 low(infinity), high(-infinity);
  for (const auto& polygon : polygons_mm)
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      edges.push_back({polygon[i], polygon[(i + 1) % polygon.size()]});
      low = glm::min(low, polygon[i]);
      high = glm::max(high, polygon[i]);
    }
  for (int axis = 0; axis < 3; ++axis)
    for (const auto& [direction, least, most] :
         {std::tuple(right, low.x, high.x), std::tuple(up, low.y, high.y)}) {
      if (direction[axis] == 1.0) box.low_mm[axis] = least, box.high_mm[axis] = most;
      if (direction[axis] == -1.0) box.low_mm[axis] = -most, box.high_mm[axis] = -least;
    }
  const auto inside = [right, up, edges](const Line& line, const Spans& within) {
    const glm::dvec2 from(glm::dot(line.from_mm, right), glm::dot(line.from_mm, up));
    const glm::dvec2 along(glm::dot(line.along, right), glm::dot(line.along, up));
    // The positions at which the projected line crosses edges, also before the line's start. By the even-odd
    // rule the part between the first and the second crossing is inside, and so on.
    const glm::dvec2 across(-along.y, along.x);
    std::vector<double> at_mm;
    bool is_point = glm::dot(along, along) < 1e-24, holds_point = false;
    for (const auto& [a, b] : edges) {
      if (is_point) {
        if ((a.y <= from.y) == (b.y <= from.y)) continue;
        if (a.x + (from.y - a.y) / (b.y - a.y) * (b.x - a.x) > from.x) holds_point = !holds_point;
        continue;
      }
      const double side_a = glm::dot(a - from, across), side_b = glm::dot(b - from, across);
      if ((side_a <= 0.0) == (side_b <= 0.0)) continue;
      const glm::dvec2 met = a + side_a / (side_a - side_b) * (b - a);
      at_mm.push_back(glm::dot(met - from, along) / glm::dot(along, along));
    }
    if (is_point) return holds_point ? within : Spans();
    std::sort(at_mm.begin(), at_mm.end());
    Spans made;
    for (std::size_t i = 0; i + 1 < at_mm.size(); i += 2)
      for (const Span& span : clipped(within, at_mm[i], at_mm[i + 1]))
        append(made, span.low_mm, span.high_mm);
    return made;
  };
  return {inside, [box](const voxel::Box& part) { return overlap(part, box); }, box, 2.0};
}

LineReading lines_in_box(const voxel::Box& box) {
  const std::array<HalfSpace, 6> sides = sides_of(box);
  return {[sides](const Line& line, const Spans& within) {
            const auto [low_mm, high_mm] = between(line, sides);
            return clipped(within, low_mm, high_mm);
          },
          [box](const voxel::Box& part) { return overlap(part, box); }, box, 1.0};
}

LineReading lines_in_half_spaces(std::vector<HalfSpace> sides) {
  return {[sides = std::move(sides)](const Line& line, const Spans& within) {
            if (sides.empty()) return Spans();
            const auto [low_mm, high_mm] = between(line, sides);
            return clipped(within, low_mm, high_mm);
          },
          [](const voxel::Box&) { return true; }, everywhere, 1.0};
}

LineReading lines_in_both(LineReading a, LineReading b) {
  return intersection(std::move(a), std::move(b));
}

LineReading lines_in_either(LineReading a, LineReading b) {
  if (!a || !b) return {};
  if (b.cost < a.cost) std::swap(a, b);
  const voxel::Box box{glm::min(a.box_mm.low_mm, b.box_mm.low_mm),
                       glm::max(a.box_mm.high_mm, b.box_mm.high_mm)};
  const double cost = a.cost + b.cost;
  if (cost > most_cost) return {};
  return {[a = std::move(a.inside), b = std::move(b.inside)](const Line& line, const Spans& within) {
            const Spans of_a = a(line, within);
            return joined(of_a, b(line, less(within, of_a)));
          },
          [a = std::move(a.may_meet), b = std::move(b.may_meet)](const voxel::Box& part) {
            return a(part) || b(part);
          },
          box, cost};
}

LineReading lines_without(LineReading a, LineReading b) {
  if (!a || !b) return {};
  const voxel::Box box = a.box_mm;
  const auto may_meet = a.may_meet;
  LineReading made = intersection(std::move(a), complement(std::move(b)));
  made.box_mm = box;
  made.may_meet = may_meet;
  return made;
}

LineReading lines_moved(LineReading still, const glm::dmat4& moved_from_still) {
  if (!still || still.cost > most_cost) return {};
  const glm::dmat4 back = glm::inverse(moved_from_still);
  return {
      [inside = still.inside, back](const Line& line, const Spans& within) {
        const glm::dvec3 along = glm::dmat3(back) * line.along;
        const double scale = glm::length(along);
        Spans scaled = within;
        for (Span& span : scaled) span = {span.low_mm * scale, span.high_mm * scale};
        Spans made = inside({glm::dvec3(back * glm::dvec4(line.from_mm, 1.0)), along / scale}, scaled);
        for (Span& span : made) span = {span.low_mm / scale, span.high_mm / scale};
        return made;
      },
      [may_meet = still.may_meet, back](const voxel::Box& part) { return may_meet(moved_box(part, back)); },
      moved_box(still.box_mm, moved_from_still), still.cost + 10.0};
}

LineReading lines_in_expression(std::string_view text,
                                const std::function<LineReading(const std::string&)>& lookup) {
  std::vector<LineReading> stack;
  for (const std::string& word : postfix(text)) {
    const char symbol = word[0];
    if (std::string_view("|^&-~").find(symbol) == std::string_view::npos) {
      stack.push_back(lookup(word));
      if (!stack.back()) return {};
      continue;
    }
    LineReading b = std::move(stack.back());
    stack.pop_back();
    if (symbol == '~') {
      stack.push_back(complement(std::move(b)));
      if (!stack.back()) return {};
      continue;
    }
    LineReading& a = stack.back();
    if (symbol == '|') a = lines_in_either(std::move(a), std::move(b));
    if (symbol == '&') a = intersection(std::move(a), std::move(b));
    if (symbol == '-') a = lines_without(std::move(a), std::move(b));
    if (symbol == '^') {
      LineReading only_a = lines_without(a, b);
      a = lines_in_either(std::move(only_a), lines_without(std::move(b), a));
    }
    if (!a) return {};
  }
  return stack.back();
}

}  // namespace octotomy::verify
