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

// Computes the parts of straight lines that lie inside an object. It evaluates the plan's expression on the
// scan's own samples. No kernel and no witness uses its code for interpolation, window and parser.
namespace octotomy::verify {

/// A straight line, LPS millimetres; `along` has length 1.
struct Line {
  glm::dvec3 from_mm{0.0}, along{1.0, 0.0, 0.0};
};

/// A part of a line. Positions are distances from Line::from_mm in millimetres.
struct Span {
  double low_mm = 0.0, high_mm = 0.0;
};
/// Disjoint spans in ascending order.
using Spans = std::vector<Span>;

/// Computes the parts of lines inside one object. Empty: the object has no reading along lines. Safe to call
/// from several threads.
struct LineReading {
  /// Returns the parts of `within` that lie inside the object.
  std::function<Spans(const Line& line, const Spans& within)> inside = nullptr;
  /// Whether a box may hold a part of the object. If false, it certainly holds none.
  std::function<bool(const voxel::Box& box)> may_meet = nullptr;
  voxel::Box box_mm{};  ///< holds the object; infinite sides: the object is unbounded there
  double cost = 1.0;    ///< of reading a line; 1 is the cost for a box

  explicit operator bool() const { return static_cast<bool>(inside); }
};

/// The points at which the trilinear interpolant of the samples lies in low..high. The object ends half a
/// sample beyond the outermost samples. Shares the scan.
LineReading lines_in_window(std::shared_ptr<const voxel::Scene> scan, double low, double high);
/// The inside of polygons by the even-odd rule. They lie in a picture plane with the axes `right` and `up`,
/// and extend without limit across the plane.
LineReading lines_in_region(const glm::dvec3& right, const glm::dvec3& up,
                            const std::vector<std::vector<glm::dvec2>>& polygons_mm);
LineReading lines_in_box(const voxel::Box& box);
/// The intersection of half-spaces normal . p <= offset_mm. Without half-spaces the object is empty.
struct HalfSpace {
  glm::dvec3 normal{1.0, 0.0, 0.0};
  double offset_mm = 0.0;
};
LineReading lines_in_half_spaces(std::vector<HalfSpace> sides);

/// Booleans: a and b, a or b, a without b. The result is empty if an operand is empty, or if reading a line
/// would cost more than reading two hundred windows.
LineReading lines_in_both(LineReading a, LineReading b);
LineReading lines_in_either(LineReading a, LineReading b);
LineReading lines_without(LineReading a, LineReading b);
/// The object under an affine map, LPS to LPS.
LineReading lines_moved(LineReading still, const glm::dmat4& moved_from_still);
/// The object of an expression of names with | ^ & - ~ (listed from the weakest binding) and parentheses.
/// Throws std::invalid_argument for any other text, and as `lookup`.
LineReading lines_in_expression(std::string_view text,
                                const std::function<LineReading(const std::string&)>& lookup);

}  // namespace octotomy::verify
