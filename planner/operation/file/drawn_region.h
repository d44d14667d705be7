// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "voxel/solid/region_mask.h"

// Reads regions as users write them on the command line: a view and a file, a drawing over a picture, or the
// pixels of a picture.
namespace octotomy::planner {

/// A region of a plan: points in the view's millimetres, rounded to 0.0001 mm.
struct DrawnRegion {
  std::string view;  ///< name of the region's view; empty if the view has no name, for example of an oblique
                     ///< slice that is turned in its plane
  voxel::Region region;
  std::vector<std::string> findings;
};

/// Lines that approximate a curve deviate from it by at most this distance.
inline constexpr double curve_tolerance_mm = 0.02;

/// Reads VIEW:FILE, or FILE alone if it is an SVG drawing over a picture. The file is one of:
/// - JSON of polygons (region_file.h);
/// - an SVG drawing (svg_outlines.h). If it contains an image that `render` or `slice` wrote, linked or
///   embedded, its outlines are positions in that picture and have the picture's view. Otherwise x is u and
///   -y is v, in millimetres;
/// - 3D Slicer's markups (.mrk.json): closed curves, LPS or RAS, projected along the view.
/// Throws std::runtime_error with the faulty text, its place in the file and the expected form.
DrawnRegion read_drawn_region(const std::string& text);

/// Reads "PICTURE.png:X,Y X,Y X,Y": corners in pixels from the top left, where whole numbers are pixels'
/// centres. A semicolon begins another polygon. The picture must be a .png that `render` or `slice` wrote.
/// Throws as read_drawn_region().
DrawnRegion region_of_pixels(const std::string& text);

}  // namespace octotomy::planner
