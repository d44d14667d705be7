// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"
#include "voxel/space/view.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/interpolate.h"
#include "voxel/tree/octree.h"
#include "voxel/view/annotation.h"
#include "voxel/view/radiograph.h"

// Makes pictures, in true scale, of a plane or a curved sheet through samples (thesis 2.2.1: reformatting).
namespace octotomy::voxel {

/// A sheet of square pixels in the patient, LPS millimetres. Every column is a straight line along `down`;
/// the columns may follow a curve. Lengths in the picture are lengths on the sheet.
struct Sheet {
  std::vector<glm::dvec3> columns_mm;  ///< centres of the top row's pixels, from the left
  glm::dvec3 down{0, 0, -1};           ///< unit vector from a pixel to the one below it
  double pixel_mm = 1.0;
  int height_px = 0;

  glm::ivec2 size_px() const { return {static_cast<int>(columns_mm.size()), height_px}; }
  glm::dvec3 lps_mm(int column, int row) const {
    return columns_mm[static_cast<std::size_t>(column)] + down * (pixel_mm * row);
  }
};

/// The largest number of pixels along a side of a sheet.
inline constexpr int most_sheet_px = 8192;

/// The smallest sheet that shows the whole cut of a plane through the lattice, voxel edges included. The
/// plane consists of the points p with p . view.look = position_mm. If the view's axes and pixel_mm are those
/// of the lattice, pixel centres are voxel centres. The view sets the radiological convention: "inferior" for
/// axial slices and "anterior" for coronal ones have the patient's left on the picture's right. Throws
/// std::invalid_argument if the plane misses the lattice, a number is not finite, pixel_mm is not positive,
/// or the picture has more than most_sheet_px a side.
Sheet plane_sheet(const Lattice& lattice, const View& view, double position_mm, double pixel_mm);

struct CurveOptions {
  std::vector<glm::dvec3> points_mm;  ///< at least two, LPS, from the picture's left to its right
  glm::dvec3 up{0, 0, 1};             ///< the picture's upward direction; any length above 0
  /// Height of the picture; its middle is the mean of the points' lowest and highest position along `up`.
  double height_mm = 60.0;
  double pixel_mm = 1.0;
};
/// The unrolled sheet through a curve, as for a panoramic view of a dental arch: it consists of the lines
/// along `up` through the polyline of the points. Throws std::invalid_argument as plane_sheet() does, and if
/// `up`, or the polyline after projection along `up`, has no length.
Sheet curved_sheet(const CurveOptions& options);

/// Samples at a sheet's pixels; `inside` is 0 for pixels outside the scan.
struct SheetSamples {
  RayImage image;
  std::vector<std::uint8_t> inside;
};
/// Samples a scene at a sheet's pixels. Pixels beyond the scan get the values of its border. Pixels beyond
/// the scan, and those whose value depends on padding, are not inside. Throws Stopped. Parallel over rows,
/// same bits on any thread count.
SheetSamples sample(const Scene& scene, const Sheet& sheet, Interpolation interpolation,
                    const Progress& progress = {});
/// Samples a grey octree at a sheet's pixels, in its scan's unit. Pixels beyond the universe get the
/// background.
SheetSamples sample(const GreyOctree& grey, const Sheet& sheet, Interpolation interpolation,
                    const Progress& progress = {});

/// The cut of an octree: 1 for pixels whose centre lies in a voxel of the octree, 0 for other pixels.
/// Parallel over rows.
std::vector<std::uint8_t> cut(const Octree& octree, const Sheet& sheet);

/// The outline of a cut, one pixel wide: the cut's pixels of which at least one of the four neighbours lies
/// in the picture but not in the cut.
std::vector<std::uint8_t> outline(const std::vector<std::uint8_t>& cut, const glm::ivec2& size_px);

/// The letters at a sheet's four edges: the directions from its middle column to its ends, and up and down.
/// An end that coincides with the middle, as on a single column or a closed curve, has no letter.
EdgeLetters edge_letters(const Sheet& sheet);

}  // namespace octotomy::voxel
