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
  std::filesystem::path file;  ///< the file with the names; empty if there is none
  /// Remarks for the user, each with its reason: files beside the label map that look like its table but are
  /// not used, rows of the table without a usable label or name, and the table's encoding if it is not UTF-8.
  std::vector<std::string> passed_over = {};

  /// The label with this name. Names are compared in composed() form, because a character may be encoded in
  /// several ways. Throws std::runtime_error if no label has the name, listing the nearest names, or if
  /// several labels have it, listing their numbers.
  int label(const std::string& name) const;
};

/// Reads a table of labels: JSON ({"liver": 5}, {"5": "liver"}, {"labels": either}, [{"label": 5, "name":
/// "liver"}] as TotalSegmentator and nnU-Net write them, or dcmqi's "segmentAttributes"); .csv or .tsv, with
/// a header that names a column of labels and one of names, or two columns; ITK-SNAP's .txt and .label,
/// FreeSurfer's .txt, FSL's .lut and 3D Slicer's .ctbl. Headings and keys are compared by their letters and
/// digits, without case: "Label Value" equals "label_value", "#No." equals "no". In a .tsv the column "index"
/// has the labels (BIDS), or "label" if there is no "index"; a further column of other numbers is reported in
/// `passed_over`. Label 0 is left out; so are, with a line in `passed_over`, rows of a label below 0 or above
/// the largest, without a label or a name, and a text's heading. Text is UTF-8, UTF-16 or Latin-1 as
/// decoded() detects it. Throws std::runtime_error with path and line where a file is none of these, has two
/// names for one label, or two labels of one name.
LabelTable read_label_table(const std::filesystem::path& path);

/// The names of a label map: those in its file; else those of the first table beside it that has the label
/// map's name up to the extension, with or without "_labels", "-labels" or "_ColorTable". For a BIDS "_dseg"
/// file, also a "dseg.tsv" in its folder or the three folders above, if the label map's name has all entities
/// of the table's name. Three kinds of files do not count as tables and are listed in `passed_over`: files
/// that read_label_table() refuses; files with a quantity of an acquisition, such as "SliceThickness"; and
/// files none of whose labels is in `occurring`, unless that is empty. Throws as voxel::label_names().
LabelTable label_table_of(const std::filesystem::path& label_map, const std::set<int>& occurring = {});

/// The names of the labels that occur in `scene`, by label_table_of(); `file` is the file of the scene.
/// Objects made from the scene have these names. Empty if the scene is not a label map.
LabelTable names_of_labels(const voxel::Scene& scene, const std::filesystem::path& file);

/// A finding on labels that are stored as fractions: their numbers, and the largest distance from a whole
/// number. Empty if all are whole.
std::vector<std::string> findings_of_labels(const std::vector<voxel::Label>& labels);

}  // namespace octotomy::planner
