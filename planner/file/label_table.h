// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace octotomy::planner {

/// The names of labels.
struct LabelTable {
  std::map<int, std::string> names;
  std::filesystem::path file;  ///< that has them; empty where there are none

  /// The label of a name. Throws std::runtime_error with the names that there are.
  int label(const std::string& name) const;
};

/// A table of labels: JSON ({"liver": 5}, {"5": "liver"}, {"labels": either}, [{"label": 5, "name": "liver"}]
/// as TotalSegmentator and nnU-Net write them); .csv or .tsv, with a header that names a column of labels and
/// one of names, or two columns; ITK-SNAP's .txt and 3D Slicer's .ctbl. Label 0 is left out. Throws
/// std::runtime_error with path and line where a file is none of these, has two names for one label, or two
/// labels of one name.
LabelTable read_label_table(const std::filesystem::path& path);

/// The names of a label map: its own, else of the table beside it whose name is its own up to the extension,
/// with or without "_labels" or "-labels". Empty where neither is there. Throws as read_label_table() and
/// voxel::label_names().
LabelTable label_table_of(const std::filesystem::path& label_map);

}  // namespace octotomy::planner
