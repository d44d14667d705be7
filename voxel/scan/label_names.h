// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace octotomy::voxel {

/// A segment of 3D Slicer's .seg.nrrd. Segments that overlap stand in layers, which number theirs anew.
struct SlicerSegment {
  std::string name;
  int layer = 0;
  int value = 0;  ///< its samples in its layer
  /// Its label here: the value, or where a segment of another layer has that, the next one free. Segments
  /// of one layer and value have one number, as nothing tells their samples apart.
  int number = 0;
};
/// The segments that a NRRD's header lists, in its order; none of other files. Cost: the header.
std::vector<SlicerSegment> slicer_segments(const std::filesystem::path& path);

/// The names that a label map's own file has for its labels, in UTF-8: those of a DICOM segmentation's
/// segments, and of 3D Slicer's (Segment0_Name with Segment0_LabelValue in the header of .seg.nrrd). Segments
/// that share a number have one name, "Mandible + Maxilla". Empty where the file has none or is of another
/// kind. Throws Error, Input, with path and reason, where a DICOM segmentation is damaged. Cost: the header;
/// of DICOM the file.
std::map<int, std::string> label_names(const std::filesystem::path& path);

}  // namespace octotomy::voxel
