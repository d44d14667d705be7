// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// A region of interest of a DICOM structure set.
struct Structure {
  int number = 0;
  std::string name;  ///< as written, in UTF-8
  /// Closed planar contours, LPS, with their offset added; the closing edge is implied.
  std::vector<std::vector<glm::dvec3>> contours_mm;
  std::size_t others = 0;      ///< number of points and open lines, which enclose no area
  std::size_t degenerate = 0;  ///< number of closed contours of one or two points, which enclose no area
  std::size_t miscounted = 0;  ///< number of contours whose point count differs from NumberOfContourPoints
  /// Stated and actual point count of the first such contour.
  std::size_t stated_points = 0, held_points = 0;
  /// Number of contours whose points a ContourOffsetVector moved.
  std::size_t moved = 0;
  glm::dvec3 farthest_offset_mm{0.0};  ///< the longest of these vectors, LPS
  std::string flaw = {};               ///< why the contours cannot be read; empty: they can
  /// Whether the file states that the region continues between neighbouring contours at any distance: the
  /// type INTERPOLATED_PLANAR.
  bool is_interpolated = false;
  double slab_mm = 0.0;                      ///< least ContourSlabThickness; 0 if any contour states none
  std::vector<std::string> frame_uids = {};  ///< the region's own frame of reference, or none
  std::vector<double> slabs_mm = {};         ///< ContourSlabThickness of each of contours_mm; 0: not stated
};

/// The regions of a structure set. `identity` contains the studies, series and frames of reference of the
/// file and of the objects to which it refers.
struct StructureSet {
  std::vector<Structure> structures;
  Identity identity;
};

/// Whether a file is a DICOM structure set, by its storage class. Returns false also for files that cannot be
/// read.
bool is_rtstruct(const std::filesystem::path& path);

/// The regions of a structure set (PS3.3, A.19), in the file's order, including regions without contours.
/// Contours may cross or contain each other. A region whose contours are damaged has its `flaw` set, so that
/// the others can be read. Throws Error (Input) with path and reason. Memory: the file's bytes and the
/// points.
StructureSet read_rtstruct(const std::filesystem::path& path);

}  // namespace octotomy::voxel
