// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/solid/region_mask.h"

// Regions as users write them on the command line: a view and a file, a drawing over a picture, or the
// pixels of a picture.
namespace octotomy::planner {

/// A region, as plans hold it: points in the view's millimetres, rounded to a ten-thousandth of one.
struct DrawnRegion {
  std::string view;  ///< the view's name; empty where it has none, as of an oblique slice turned in its plane
  voxel::Region region;
  std::vector<std::string> findings;
};

/// The largest distance of lines from the curve that they approximate.
inline constexpr double curve_tolerance_mm = 0.02;

/// VIEW:FILE, or FILE alone of an SVG drawing over a picture. The file is
/// - JSON of polygons (region_file.h);
/// - an SVG drawing (svg_outlines.h). If it contains an image that `render` or `slice` wrote, linked or
///   embedded, its outlines lie in that picture and have its view; else x is u and -y is v, in millimetres;
/// - 3D Slicer's markups (.mrk.json): closed curves, LPS or RAS, projected along the view.
/// Throws std::runtime_error with the text that was given, its place in the file and the text expected there.
DrawnRegion read_drawn_region(const std::string& text);

/// "PICTURE.png:X,Y X,Y X,Y" in pixels from the top left, whole numbers at pixels' centres; a semicolon begins
/// another polygon. The picture is one that `render` or `slice` wrote. Throws as read_drawn_region().
DrawnRegion region_of_pixels(const std::string& text);

}  // namespace octotomy::planner
