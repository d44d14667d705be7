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
  std::filesystem::path file;  ///< the file that has the names; empty where there are none
  /// Files beside a label map that look like its table but are no table or contradict the map, and rows of
  /// the table that name no label, each with the reason; also the encoding of a table that is not UTF-8.
  std::vector<std::string> passed_over = {};

  /// The label with a name. Names are compared in composed() form, because one name has several encodings.
  /// Throws std::runtime_error that lists the known names, or the labels if several have that name.
  int label(const std::string& name) const;
};

/// A table of labels: JSON ({"liver": 5}, {"5": "liver"}, {"labels": either}, [{"label": 5, "name":
/// "liver"}] as TotalSegmentator and nnU-Net write them, or dcmqi's "segmentAttributes"); .csv or .tsv,
/// with a header that names a column of labels and one of names, or two columns; ITK-SNAP's .txt and
/// .label, FreeSurfer's .txt, FSL's .lut and 3D Slicer's .ctbl. Only letters and digits of headings and
/// keys count, without case: "Label Value" equals "label_value", "#No." equals "no". In a .tsv the column
/// "index" has the labels (BIDS), or "label" if there is no "index"; a further column of other numbers is
/// reported in `passed_over`. Label 0 is left out; so are, with a line in `passed_over`, rows of a label
/// below 0 or above the largest, without a label or a name, and a text's heading. Text is UTF-8, UTF-16 or
/// Latin-1 as decoded() detects it. Throws std::runtime_error with path and line where a file is none of
/// these, has two names for one label, or two labels of one name.
LabelTable read_label_table(const std::filesystem::path& path);

/// The names of a label map: its own; else those of the first table beside it whose name is the label map's
/// up to the extension, with or without "_labels", "-labels" or "_ColorTable". For a BIDS "_dseg" file also
/// a "dseg.tsv" in its folder or in one of three above, if the label map's name has all of that table's
/// entities. Three kinds of files are not tables and are listed in `passed_over`: files that
/// read_label_table() refuses; files with a quantity of an acquisition, such as "SliceThickness"; and files
/// none of whose labels is in `occurring`, unless that is empty. Throws as voxel::label_names().
LabelTable label_table_of(const std::filesystem::path& label_map, const std::set<int>& occurring = {});

/// The names for the labels that occur in a scan that was read from the file, by label_table_of(). Objects
/// made from the scan keep them. Empty if the scan is not a label map.
LabelTable names_of_labels(const voxel::Scene& scene, const std::filesystem::path& file);

/// A line on labels that are stored as numbers with a fraction: their numbers and their largest deviation.
/// Empty if all are whole.
std::vector<std::string> findings_of_labels(const std::vector<voxel::Label>& labels);

}  // namespace octotomy::planner
