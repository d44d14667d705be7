// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace octotomy::voxel {

/// A segment of 3D Slicer's .seg.nrrd. Segments that overlap are in different layers, and each layer numbers
/// its segments separately.
struct SlicerSegment {
  std::string name;
  int layer = 0;
  int value = 0;  ///< value of the segment's samples in its layer
  /// The segment's label in the label map: `value`, or the next free number if a segment of another layer has
  /// that value. Segments with the same layer and value have the same number, because their samples cannot be
  /// distinguished.
  int number = 0;
};
/// The segments that the header of a NRRD file lists, in the header's order; empty for other files. Cost:
/// reads the header.
std::vector<SlicerSegment> slicer_segments(const std::filesystem::path& path);

/// The names of a label map's labels, as stated in its file, in UTF-8: the labels of a DICOM segmentation's
/// segments, or the names of 3D Slicer's (Segment0_Name with Segment0_LabelValue in the header of .seg.nrrd).
/// Segments that share a number have one name, "Mandible + Maxilla". Empty if the file states no names or is
/// of another kind. Throws Error (Input) with path and reason, if a DICOM segmentation is damaged. Cost:
/// reads the header, or the whole file for DICOM.
std::map<int, std::string> label_names(const std::filesystem::path& path);

}  // namespace octotomy::voxel
