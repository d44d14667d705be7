// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/field.h"

namespace octotomy::planner {

/// A volume of interest: the intersection of the back-projections of regions drawn in views and of the volume
/// that regions on slices enclose.
struct Mask {
  struct Region {
    std::string view;  ///< a view's name or angles as for pictures: "anterior", "35,15"
    Polygons polygons_mm;
    std::vector<std::string> curves;  ///< files of closed curves of 3D Slicer, more polygons of the region
  };
  std::vector<Region> regions;
  std::vector<std::string> planes;  ///< files of 3D Slicer's planes; the mask is where their normals point
  std::string views_of = "head";    ///< "head": views of the head as it is positioned; "scan": views along
                                    ///< the scan's axes
  std::filesystem::path slices;     ///< a file of regions on parallel slices; the mask is within them as well
  std::string structure;            ///< the region of a structure set in that file
  std::optional<double> bridge_mm;  ///< gaps between the structure's planes that are filled
  bool other_identity = false;  ///< the structure set may be of another patient, study or frame of reference
  // Of the command only.
  std::vector<std::string> region_files;   ///< VIEW:FILE
  std::vector<std::string> region_pixels;  ///< PICTURE.png:X,Y X,Y X,Y
  std::filesystem::path edit, like, out;
  std::optional<double> voxel_mm;
};

/// The mask with the regions of its files: curves become polygons of their region. A plane becomes a region
/// of its own, in a view that sees the plane edge-on: a rectangle of four kilometres that ends at the
/// plane. Files are in LPS. If the mask's views are relative to the head, the files' points are first
/// converted to the head's directions, so that the mask lies where the files place it. Adds findings on the
/// files. Throws std::runtime_error as read_slicer_markups().
Mask with_files_read(const Mask& mask, const std::filesystem::path& folder, const glm::dmat3& lps_from_head,
                     std::vector<std::string>& findings);
Mask with_files_read(const Mask& mask, const std::filesystem::path& folder, const glm::dmat3& lps_from_head);

}  // namespace octotomy::planner
