// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace octotomy::brep {

/// Samples on a rectangle, x-fastest. Sample (i, j) is at (i, j) * spacing_mm in the slice's own plane.
struct Slice {
  std::span<const float> samples;  ///< width * height samples
  std::uint32_t width = 0, height = 0;
  glm::dvec2 spacing_mm{1.0, 1.0};
};

/// A line in a slice's plane; a closed one continues from its last point to its first. The object is on its
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

/// All contours of a slice at a threshold. Crossings are interpolated linearly between neighbouring samples.
/// Contours do not cross or touch themselves or each other. Where only diagonally opposite corners of a cell
/// are inside, they are connected as by the bilinear interpolant. Open lines come first, then closed ones,
/// each group by its first crossing in storage order. Throws std::invalid_argument, which names the cause, if
/// the size does not fit the samples, the spacing is not positive, or the threshold or a sample is not
/// finite. Cost: linear, 9 bytes per edge between samples. Source: Lorensen and Cline 1987 in the plane;
/// Nielson and Hamann, "The asymptotic decider", Visualization 1991.
std::vector<Contour> follow(const Slice& slice, const FollowOptions& options);

/// Throws std::invalid_argument if a contour is open; the message begins with `asking`, the name of the
/// calling function.
void need_closed(const Contour& contour, const char* asking);

/// The area a closed contour encloses, positive counter-clockwise. Throws std::invalid_argument if it is
/// open.
double signed_area_mm2(const Contour& contour);

/// Length of the line, including the closing piece if it is closed.
double perimeter_mm(const Contour& contour);

/// For each contour, the index of the smallest one around it, or none. Precondition: contours are closed and
/// simple and do not cross each other; they may touch. Throws std::invalid_argument if one is open. Cost: n
/// log n in the points, and one test for each pair of contours whose larger bounding box contains the smaller
/// one.
std::vector<std::optional<std::size_t>> nest(const std::vector<Contour>& contours);

/// The number of contours around each, from the result of nest(): outer boundaries have an even depth, holes
/// an odd one. Cost: linear.
std::vector<std::size_t> depths(const std::vector<std::optional<std::size_t>>& around);

}  // namespace octotomy::brep
