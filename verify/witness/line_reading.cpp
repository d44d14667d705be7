// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Windows: a line is followed through the scan in steps of an eighth of a sample. The interpolant counts as
// linear within a step. So the ends of a span have an error of a few thousandths of a sample, and layers thinner
// than an eighth of a sample may be missed where the interpolant bends. The errors have one sign where a scan is
// noise: steps of half a sample lose 2 % of the volume of its peaks, these a tenth of that. Bricks of 4 cells a
// side whose samples all lie inside or all outside the window are passed in one step. Steps lie at multiples of
// their length from the line's start. So the ends of a span do not depend on which part of the line is read, and
// an object minus itself is empty. Expressions: two stacks put operators and names into postfix order (Dijkstra's
// shunting yard); then the readings are joined.
#include "verify/witness/line_reading.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>
#include <variant>

#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const voxel::Box everywhere{glm::dvec3(-infinity), glm::dvec3(infinity)};

/// Appends a span, or extends the last span if both touch. Precondition: it begins no sooner than the last
/// span.
void append(Spans& spans, double low_mm, double high_mm) {
  if (!(high_mm > low_mm)) return;
  constexpr double touching_mm = 1e-9;
  if (!spans.empty() && low_mm <= spans.back().high_mm + touching_mm)
    spans.back().high_mm = std::max(spans.back().high_mm, high_mm);
  else
    spans.push_back({low_mm, high_mm});
}

/// The parts of `within` between two positions on the line.
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

/// Start and end of the part of a line on the inner side of all planes. Start exceeds end if there is none.
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

/// Computes the parts of lines inside the window of a scan.
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
    const double step_mm = 0.125 / std::max({std::abs(du.x), std::abs(du.y), std::abs(du.z)});
    Spans inside;
    for (const Span& span : clipped(within, low_mm, high_mm)) follow(u0, du, step_mm, span, inside);
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

  /// The range of a brick's samples, including the first samples of the next bricks.
  struct Range {
    Sample least = std::numeric_limits<Sample>::max(), most = std::numeric_limits<Sample>::lowest();
    bool is_finite = true;

    void add(const Range& other) {
      least = std::min(least, other.least);
      most = std::max(most, other.most);
      is_finite = is_finite && other.is_finite;
    }
  };

  /// Sets the states of one layer of bricks.
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

  /// The position at which a line leaves a brick. The outermost bricks extend beyond the samples without end.
  double leaves_mm(const glm::dvec3& u0, const glm::dvec3& du, const glm::ivec3& b) const {
    double at_mm = infinity;
    for (int axis = 0; axis < 3; ++axis) {
      if (du[axis] > 0.0 && b[axis] + 1 < bricks_[axis])
        at_mm = std::min(at_mm, ((b[axis] + 1.0) * brick - u0[axis]) / du[axis]);
      if (du[axis] < 0.0 && b[axis] > 0)
        at_mm = std::min(at_mm, (b[axis] * brick * 1.0 - u0[axis]) / du[axis]);
    }
    return at_mm;
  }

  double value(const glm::dvec3& u) const {
    glm::ivec3 first;
    glm::dvec3 part;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = std::clamp(u[axis], 0.0, dims_[axis] - 1.0);
      first[axis] = std::min(static_cast<int>(at), std::max(dims_[axis] - 2, 0));
      part[axis] = at - first[axis];
    }
    const glm::ivec3 next = glm::min(first + 1, dims_ - 1);
    if (scan_->padding && has_padding(first, next)) return nearest(first, part, next);
    const auto row = [&](int y, int z) {
      const auto a = static_cast<double>(*sample(first.x, y, z)),
                 b = static_cast<double>(*sample(next.x, y, z));
      return a + part.x * (b - a);
    };
    const auto slice = [&](int z) {
      const double a = row(first.y, z), b = row(next.y, z);
      return a + part.y * (b - a);
    };
    const double a = slice(first.z), b = slice(next.z);
    return a + part.z * (b - a);
  }

  bool has_padding(const glm::ivec3& first, const glm::ivec3& next) const {
    for (const int z : {first.z, next.z})
      for (const int y : {first.y, next.y})
        for (const int x : {first.x, next.x})
          if (static_cast<double>(*sample(x, y, z)) == *scan_->padding) return true;
    return false;
  }

  /// The value of the nearest sample, because there is no interpolation between a sample and padding. NaN if
  /// the nearest sample is padding.
  double nearest(const glm::ivec3& first, const glm::dvec3& part, const glm::ivec3& next) const {
    const auto value = static_cast<double>(*sample(
        part.x < 0.5 ? first.x : next.x, part.y < 0.5 ? first.y : next.y, part.z < 0.5 ? first.z : next.z));
    return value == *scan_->padding ? std::numeric_limits<double>::quiet_NaN() : value;
  }

  /// A step of a line: its start and end, and the interpolant's values there.
  struct Step {
    double low_mm, high_mm, f0, f1;
  };

  /// Adds the part of a step that lies within `part` and in the window.
  void add_step(const Step& step, const Span& part, Spans& inside) const {
    const auto [low_mm, high_mm, f0, f1] = step;
    if (!std::isfinite(f0) || !std::isfinite(f1)) return;
    double from = 0.0, to = 1.0;
    if (f0 == f1) {
      if (f0 < low_ || f0 > high_) return;
    } else {
      const double a = (low_ - f0) / (f1 - f0), b = (high_ - f0) / (f1 - f0);
      from = std::clamp(std::min(a, b), 0.0, 1.0);
      to = std::clamp(std::max(a, b), 0.0, 1.0);
    }
    append(inside, std::max(low_mm + from * (high_mm - low_mm), part.low_mm),
           std::min(low_mm + to * (high_mm - low_mm), part.high_mm));
  }

  /// The interpolant's value after a number of steps from the line's start.
  struct Known {
    double number, value;
  };

  /// Reads a part of a line step by step. `last` holds the last position and its value, if there is one.
  void follow_steps(const glm::dvec3& u0, const glm::dvec3& du, double step_mm, const Span& part,
                    std::optional<Known>& last, Spans& inside) const {
    for (double number = std::floor(part.low_mm / step_mm); number * step_mm < part.high_mm; ++number) {
      const double low_mm = number * step_mm, high_mm = (number + 1.0) * step_mm;
      const double f0 = last && last->number == number ? last->value : value(u0 + low_mm * du);
      last = {number + 1.0, value(u0 + high_mm * du)};
      add_step({low_mm, high_mm, f0, last->value}, part, inside);
    }
  }

  void follow(const glm::dvec3& u0, const glm::dvec3& du, double step_mm, const Span& span,
              Spans& inside) const {
    std::optional<Known> last;
    for (double at_mm = span.low_mm; at_mm < span.high_mm;) {
      // The position is moved a little forward, so that a boundary between two bricks belongs to the next
      // one.
      const glm::ivec3 b = brick_of(u0 + (at_mm + 1e-6 * step_mm) * du);
      const double out_mm = std::min(std::max(leaves_mm(u0, du, b), at_mm + 1e-3 * step_mm), span.high_mm);
      const State state = states_[index_of(b)];
      if (state == State::In) append(inside, at_mm, out_mm);
      if (state == State::Mixed) follow_steps(u0, du, step_mm, {at_mm, out_mm}, last, inside);
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

/// The cost of two hundred windows. An expression of more has no reading, nor has one whose size a plan's
/// steps double repeatedly. A line would take seconds, and the recursion would be as deep as the number of
/// operands.
constexpr double most_cost = 2e4;

/// The more expensive operand is read last, and only where the answer still depends on it.
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

/// Names and operators of an expression in postfix order.
std::vector<std::string> postfix(std::string_view text) {
  const auto refuse = [&](std::size_t at, const char* wanted) {
    throw voxel::InvalidInput("expression, position " + std::to_string(at + 1) + ": " + wanted + " expected");
  };
  const auto strength = [](char symbol) { return std::string_view("|^&-~").find(symbol); };
  std::vector<std::string> out;
  std::vector<char> waiting;
  bool wants_operand = true;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (std::isspace(static_cast<unsigned char>(c))) {
      ++at;
    } else if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
      if (!wants_operand) refuse(at, "an operator");
      const std::size_t first = at;
      while (at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_'))
        ++at;
      out.emplace_back(text.substr(first, at - first));
      wants_operand = false;
    } else if (c == '(' || c == '~') {
      if (!wants_operand) refuse(at, "an operator");
      waiting.push_back(c);
      ++at;
    } else if (c == ')' || strength(c) != std::string_view::npos) {
      if (wants_operand) refuse(at, "a name");
      while (!waiting.empty() && waiting.back() != '(' &&
             (c == ')' || strength(waiting.back()) >= strength(c))) {
        out.emplace_back(1, waiting.back());
        waiting.pop_back();
      }
      if (c == ')') {
        if (waiting.empty()) refuse(at, "an operator");
        waiting.pop_back();
      } else {
        waiting.push_back(c);
        wants_operand = true;
      }
      ++at;
    } else {
      refuse(at, "a name or an operator");
    }
  }
  if (wants_operand) refuse(text.size(), "a name");
  for (; !waiting.empty(); waiting.pop_back()) {
    if (waiting.back() == '(') refuse(text.size(), "')'");
    out.emplace_back(1, waiting.back());
  }
  return out;
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
    // Positions at which the projected line crosses edges, also behind its start. By the even-odd rule each
    // pair of successive crossings bounds an inside part.
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
