// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "voxel/filter/label_map.h"

namespace octotomy::planner {

/// The names of labels.
struct LabelTable {
  std::map<int, std::string> names;
  std::filesystem::path file;  ///< that has them; empty where there are none
  /// Files beside a label map that look like its table and are none, or contradict it, and rows of the table
  /// that name no label, each with the reason; the encoding of a table that is not UTF-8.
  std::vector<std::string> passed_over = {};

  /// The label of a name; of composed() names, so that it may be written either way. Throws
  /// std::runtime_error with the names that there are, or with the numbers of several labels of that name.
  int label(const std::string& name) const;
};

/// A table of labels: JSON ({"liver": 5}, {"5": "liver"}, {"labels": either}, [{"label": 5, "name": "liver"}]
/// as TotalSegmentator and nnU-Net write them, or dcmqi's "segmentAttributes"); .csv or .tsv, with a header
/// that names a column of labels and one of names, or two columns; ITK-SNAP's .txt and .label, FreeSurfer's
/// .txt, FSL's .lut and 3D Slicer's .ctbl. Headings and keys count by their letters and digits: "Label Value"
/// is "label_value", "#No." is "no". Of a .tsv the labels are in "index" where that is a column, as BIDS has
/// it, else in "label"; a further column of other numbers is reported in `passed_over`. Label 0 is left out;
/// so are, with a line in `passed_over`, rows of a label below 0 or above the largest, without a label or a
/// name, and a text's heading. Text is UTF-8, UTF-16 or Latin-1 as decoded() has it. Throws
/// std::runtime_error with path and line where a file is none of these, has two names for one label, or two
/// labels of one name.
LabelTable read_label_table(const std::filesystem::path& path);

/// The names of a label map: its own, else of the first table beside it whose name is its own up to the
/// extension, with or without "_labels", "-labels" or "_ColorTable"; of a BIDS "_dseg" file also the
/// "dseg.tsv" of its folder or one of three above whose entities are all the file's. A file that
/// read_label_table() refuses, that has a number of an acquisition such as "SliceThickness", or none of whose
/// labels is one of `occurring` if there are any, is no table: it is passed over. Throws as
/// voxel::label_names().
LabelTable label_table_of(const std::filesystem::path& label_map, const std::set<int>& occurring = {});

/// label_table_of() a scan that was read of the file, by the labels that occur in it, for what is made of the
/// scan to keep; without names where the scan is no label map.
LabelTable names_of_labels(const voxel::Scene& scene, const std::filesystem::path& file);

/// A line on labels that are stored as numbers with a fraction: which, and how far off they are. None where
/// all are whole.
std::vector<std::string> findings_of_labels(const std::vector<voxel::Label>& labels);

}  // namespace octotomy::planner
