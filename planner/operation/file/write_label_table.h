// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

// The names of a label map's labels beside it, in a form that label_table_of() finds and reads.
namespace octotomy::planner {

/// The label map's path with .tsv in place of its extension.
std::filesystem::path label_table_path(const std::filesystem::path& label_map);

/// Whether a table has exactly these names, in this spelling or in that of label_table_text(). False if the
/// file is no label table.
bool holds_names(const std::filesystem::path& table, const std::map<int, std::string>& names);

/// A table in BIDS form, with the columns index and name. Tabs and line breaks in names become blanks; a
/// name of several labels is followed by each label's number, as "Bone (label 7)".
std::string label_table_text(const std::map<int, std::string>& names);

/// Throws std::runtime_error if a file with the table's name exists and does not hold these names, because
/// a reader would use it for the label map. Exception: if the label map exists too and is replaced, a table
/// that label_table_text() made is also replaced, as the two belong together. To be called before the label
/// map is written.
void need_label_table(const std::filesystem::path& label_map, const std::map<int, std::string>& names);

/// Writes the table beside the label map, unless a file there already has these names. Returns the
/// findings: the file that was written, and the names that it spells differently. Throws as
/// need_label_table() and voxel::write_whole().
std::vector<std::string> write_label_table(const std::filesystem::path& label_map,
                                           const std::map<int, std::string>& names);

}  // namespace octotomy::planner
