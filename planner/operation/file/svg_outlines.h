// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The picture that an SVG file was drawn over: the file's first image.
struct SvgPicture {
  std::string link;             ///< as the file states it: a path relative to the file, or data:image/png
  glm::dvec2 shown_units{0.0};  ///< width and height that the file states
  bool keeps_aspect = true;     ///< the picture is fitted into `shown_units` and centred there
  /// From a place within the picture's rectangle, in the rectangle's own units, from the top left.
  glm::dmat3 user_from_shown{1.0};
  std::size_t line = 0;
};

/// Places user units: an affine map to millimetres of a view.
using SvgPlacement = std::function<glm::dmat3(double mm_per_unit, const std::optional<SvgPicture>& picture)>;

struct SvgOutlines {
  std::vector<std::vector<glm::dvec2>> polygons_mm;
  /// What was left out, and the length that a user unit is assumed to have.
  std::vector<std::string> findings;
};

/// The closed outlines of an SVG file: path, polygon, polyline, rect, circle and ellipse with their
/// transforms, of all groups that are displayed. Open outlines close as they do when filled; curves become
/// lines that are nowhere farther than `tolerance_mm` from them. User units are the length that the root's
/// width and viewBox give them; a pixel is 1/96 inch, or 1/72 in files of Adobe Illustrator, or 1/90 in
/// those of Inkscape before 0.92. This is an assumption and therefore a finding, and so is a root without a
/// width. Clip paths and masks are not read: each that holds an outline is a finding. Throws
/// std::runtime_error with file, line and reason if the file is no SVG, a shape cannot be read, or there is
/// no outline.
SvgOutlines read_svg_outlines(const std::filesystem::path& path, const SvgPlacement& place,
                              double tolerance_mm);

}  // namespace octotomy::planner
