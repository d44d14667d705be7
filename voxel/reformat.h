// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <stop_token>
#include <vector>

#include "voxel/annotation.h"
#include "voxel/grey_octree.h"
#include "voxel/interpolate.h"
#include "voxel/octree.h"
#include "voxel/radiograph.h"
#include "voxel/scene.h"
#include "voxel/view.h"

// Pictures of what lies in a plane or in a curved sheet (thesis 2.2.1: reformatting), in true scale.
namespace octotomy::voxel {

/// A sheet of square pixels in the patient, LPS millimetres. Every column is a straight line along `down`;
/// columns may follow a curve. Lengths measured in the picture are lengths on the sheet.
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

/// Pictures are at most so many pixels a side.
inline constexpr int most_sheet_px = 8192;

/// Where the plane of points with p . view.look = position_mm cuts the lattice, voxel edges included: the
/// smallest picture that shows all of the cut. Where axes and pixels are the lattice's, pixels' centres are
/// voxels' centres. Radiological convention comes with the view: "inferior" for axial slices and "anterior"
/// for coronal ones have the patient's left on the picture's right. Throws std::invalid_argument where the
/// plane misses the lattice, a number is not finite, a pixel not positive, or the picture has more than
/// most_sheet_px a side.
Sheet plane_sheet(const Lattice& lattice, const View& view, double position_mm, double pixel_mm);

struct CurveOptions {
  std::vector<glm::dvec3> points_mm;  ///< at least two, LPS, from the picture's left to its right
  glm::dvec3 up{0, 0, 1};             ///< of the picture; made a unit vector
  double height_mm = 60.0;            ///< of the picture, half above and half below the points' middle height
  double pixel_mm = 1.0;
};
/// The sheet through a curve, as for a panoramic view of a dental arch: lines along `up` through the polyline
/// that the points' projections along `up` make, unrolled. Throws std::invalid_argument as plane_sheet(), and
/// where the points' projections have no length or `up` none.
Sheet curved_sheet(const CurveOptions& options);

/// Samples at a sheet's pixels; `inside` is 0 where a pixel lies beyond the scan, whose value is then that of
/// the scan's border.
struct SheetSamples {
  RayImage image;
  std::vector<std::uint8_t> inside;
};
/// Throws Stopped (read_scene.h). Parallel over rows, same bits on any thread count.
SheetSamples sample(const Scene& scene, const Sheet& sheet, Interpolation interpolation,
                    const std::stop_token& stop = {});
/// The same; beyond the universe the value is the background.
SheetSamples sample(const GreyOctree& grey, const Sheet& sheet, Interpolation interpolation,
                    const std::stop_token& stop = {});

/// 1 where a pixel's centre lies in a voxel of the octree, 0 elsewhere. Parallel over rows.
std::vector<std::uint8_t> cut(const Octree& octree, const Sheet& sheet);

/// Of a cut's pixels those with a neighbour, across one of four edges, that is in the picture but not in the
/// cut: the object's outline, one pixel wide and within it.
std::vector<std::uint8_t> outline(const std::vector<std::uint8_t>& cut, const glm::ivec2& size_px);

/// The letters at a sheet's four edges: where its ends lie as seen from its middle column, and where up and
/// down are. None at ends that lie where the middle does: of a single column, and of a closed curve.
EdgeLetters edge_letters(const Sheet& sheet);

}  // namespace octotomy::voxel
