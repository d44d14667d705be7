// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/space/lattice.h"
#include "voxel/space/scene.h"

// Where straight lines run inside an object: the plan's expression on the scan's own samples, by an
// interpolation, a window and a parser that neither kernel and no witness uses.
namespace octotomy::verify {

/// A straight line, LPS millimetres; `along` has length 1.
struct Line {
  glm::dvec3 from_mm{0.0}, along{1.0, 0.0, 0.0};
};

/// A stretch of a line, in millimetres from `from_mm`.
struct Span {
  double low_mm = 0.0, high_mm = 0.0;
};
/// Ascending and apart.
using Spans = std::vector<Span>;

/// Reads one object along lines. Empty: the object has no such reading. Safe to call from several threads.
struct LineReading {
  /// The stretches of `within` that lie inside.
  std::function<Spans(const Line& line, const Spans& within)> inside = nullptr;
  /// Whether a box may hold a part of the object; false is certain.
  std::function<bool(const voxel::Box& box)> may_meet = nullptr;
  voxel::Box box_mm{};  ///< holds the object; sides are infinite where it ends nowhere
  double cost = 1.0;    ///< of a line, relative to that of a box: the cheaper operand is read first

  explicit operator bool() const { return static_cast<bool>(inside); }
};

/// The samples low..high of the trilinear interpolant, up to half a sample beyond the outermost. Shares the
/// scan.
LineReading lines_in_window(std::shared_ptr<const voxel::Scene> scan, double low, double high);
/// What polygons enclose by the even-odd rule in a picture plane whose axes are `right` and `up`, at any
/// depth.
LineReading lines_in_region(const glm::dvec3& right, const glm::dvec3& up,
                            const std::vector<std::vector<glm::dvec2>>& polygons_mm);
LineReading lines_in_box(const voxel::Box& box);
/// The intersection of half-spaces normal . p <= offset_mm; nowhere inside without one.
struct HalfSpace {
  glm::dvec3 normal{1.0, 0.0, 0.0};
  double offset_mm = 0.0;
};
LineReading lines_in_half_spaces(std::vector<HalfSpace> sides);

/// Of operands without a reading the answer has none, nor where reading a line would cost more than two
/// hundred windows.
LineReading lines_in_both(LineReading a, LineReading b);
LineReading lines_in_either(LineReading a, LineReading b);
LineReading lines_without(LineReading a, LineReading b);
/// Under an affine motion, LPS to LPS.
LineReading lines_moved(LineReading still, const glm::dmat4& moved_from_still);
/// Of an expression of names under | ^ & - ~ and parentheses, the weakest first. Throws std::invalid_argument
/// for any other text, and as `lookup`.
LineReading lines_in_expression(std::string_view text,
                                const std::function<LineReading(const std::string&)>& lookup);

}  // namespace octotomy::verify
