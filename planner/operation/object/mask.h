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
    std::vector<std::string> curves;  ///< files of 3D Slicer's closed curves, which add polygons to the
                                      ///< region
  };
  std::vector<Region> regions;
  std::vector<std::string> planes;  ///< files of 3D Slicer's planes; the mask lies on the side to which their
                                    ///< normals point
  std::string views_of = "head";    ///< "head": views of the head as it is positioned; "scan": views along
                                    ///< the scan's axes
  std::filesystem::path slices;     ///< a file of regions on parallel slices; the mask lies within them, too
  std::string structure;            ///< name or ROI number of the structure to use, if that file is a
                                    ///< structure set
  std::optional<double> bridge_mm;  ///< gaps up to this width between the structure's planes are interpolated
  bool other_identity = false;  ///< whether the structure set may state another patient, study or frame of
                                ///< reference
  // Of the command only.
  std::vector<std::string> region_files;   ///< VIEW:FILE
  std::vector<std::string> region_pixels;  ///< PICTURE.png:X,Y X,Y X,Y
  std::filesystem::path edit, like, out;
  std::optional<double> voxel_mm;
};

/// The mask with the content of its files. Curves become polygons of their region. A plane becomes a separate
/// region in a view that sees the plane edge-on: a rectangle of four kilometres that ends at the plane. Files
/// are in LPS. If the mask's views are relative to the head, the files' points are first converted to the
/// head's directions, so that the mask keeps its place in the scan. Adds findings on the files. Throws
/// std::runtime_error as read_slicer_markups().
Mask with_files_read(const Mask& mask, const std::filesystem::path& folder, const glm::dmat3& lps_from_head,
                     std::vector<std::string>& findings);
Mask with_files_read(const Mask& mask, const std::filesystem::path& folder, const glm::dmat3& lps_from_head);

}  // namespace octotomy::planner
