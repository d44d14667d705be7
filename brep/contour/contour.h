// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace octotomy::brep {

/// Samples on a rectangle, x-fastest. Sample (i, j) stands at (i, j) * spacing_mm in the slice's own plane.
struct Slice {
  std::span<const float> samples;  ///< width * height of them
  std::uint32_t width = 0, height = 0;
  glm::dvec2 spacing_mm{1.0, 1.0};
};

/// A line in a slice's plane; a closed one runs on from its last point to its first. The object is on its
/// left: with x to the right and y up, outer contours run counter-clockwise and holes clockwise.
struct Contour {
  std::vector<glm::dvec2> points_mm;
  bool closed = true;
};

enum class Border {
  close,      ///< the object ends half a sample beyond the outermost samples, where their pixels end
  leave_open  ///< lines that meet the border end there, with `closed` false
};

struct FollowOptions {
  double threshold = 0.0;  ///< samples at or above it are inside
  Border border = Border::close;
};

/// All contours of a slice at a threshold, crossings placed by linear interpolation between neighbouring
/// samples. Contours neither cross nor touch, themselves or each other; where two corners of a cell face each
/// other diagonally they are joined as the bilinear interpolant joins them. Open lines come first, then
/// closed ones, each group by its first crossing in storage order. Throws std::invalid_argument where the
/// size does not fit the samples, the spacing is not positive, or the threshold or a sample is not finite,
/// naming it. Cost: linear, 9 bytes a sample's edge. Source: Lorensen and Cline 1987 in the plane; Nielson
/// and Hamann, "The asymptotic decider", Visualization 1991.
std::vector<Contour> follow(const Slice& slice, const FollowOptions& options);

/// Throws std::invalid_argument where a contour is open; its message begins with who asks.
void need_closed(const Contour& contour, const char* asking);

/// The area a closed contour encloses, positive counter-clockwise. Throws std::invalid_argument where open.
double signed_area_mm2(const Contour& contour);

/// Length of the line, with the closing piece where it is closed.
double perimeter_mm(const Contour& contour);

/// For each contour the smallest one around it, by index, or none. Precondition: closed, simple, and not
/// crossing each other; they may touch. Throws std::invalid_argument where one is open. Cost: n log n in the
/// points, and for each contour the larger ones whose bounding boxes are about it.
std::vector<std::optional<std::size_t>> nest(const std::vector<Contour>& contours);

/// How many contours are around each, from what nest() returned: outer boundaries are at an even depth, holes
/// at an odd one. Cost: linear.
std::vector<std::size_t> depths(const std::vector<std::optional<std::size_t>>& around);

}  // namespace octotomy::brep
