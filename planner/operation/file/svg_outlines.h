// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

namespace octotomy::planner {

/// The picture over which a drawing was made: the file's first image.
struct SvgPicture {
  std::string link;             ///< as the file states it: a path relative to the file, or a data: URL of the
                                ///< picture
  glm::dvec2 shown_units{0.0};  ///< width and height of the picture's rectangle, in user units
  bool keeps_aspect = true;     ///< whether the picture keeps its proportions: it is then fitted into
                                ///< `shown_units` and centred there
  /// Maps positions within the picture's rectangle, counted from its top left corner, to user units.
  glm::dmat3 user_from_shown{1.0};
  std::size_t line = 0;
};

/// Computes the affine map from user units to millimetres of a view.
using SvgPlacement = std::function<glm::dmat3(double mm_per_unit, const std::optional<SvgPicture>& picture)>;

struct SvgOutlines {
  std::vector<std::vector<glm::dvec2>> polygons_mm;
  /// Findings on what was left out, and on the assumed length of a user unit.
  std::vector<std::string> findings;
};

/// The closed outlines of an SVG file: path, polygon, polyline, rect, circle and ellipse with their
/// transforms, of all groups that are displayed. Open outlines are closed by a straight line, as filling
/// does. Curves become lines that deviate from them by at most `tolerance_mm`. The root's width and viewBox
/// determine the length of a user unit. If they are in pixels, a pixel is assumed to be 1/96 inch, 1/72 in
/// files of Adobe Illustrator, or 1/90 in those of Inkscape before 0.92; a finding states this. A finding
/// also states that a root has no width. Clip paths and masks are not applied; each that contains an outline
/// is a finding. Throws std::runtime_error with file, line and reason if the file is no SVG, a shape cannot
/// be read, or there is no outline.
SvgOutlines read_svg_outlines(const std::filesystem::path& path, const SvgPlacement& place,
                              double tolerance_mm);

}  // namespace octotomy::planner
