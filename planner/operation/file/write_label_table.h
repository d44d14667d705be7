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

/// Whether a table has exactly these names, as they are or as label_table_text() spells them. False for a file
/// that is no label table.
bool holds_names(const std::filesystem::path& table, const std::map<int, std::string>& names);

/// A table as BIDS has it, with the columns index and name. Tabs and line breaks of names become blanks; a
/// name of several labels gets the number of each, as "Bone (label 7)".
std::string label_table_text(const std::map<int, std::string>& names);

/// Throws std::runtime_error where a file of the table's name is there and does not hold these names: a
/// reader would take them for the label map's. Where the label map is there too and is replaced, so is a
/// table that label_table_text() made, as the two belong together. To be called before the label map is
/// written.
void need_label_table(const std::filesystem::path& label_map, const std::map<int, std::string>& names);

/// Writes the table beside the label map, unless a file there names its labels so already. Returns the
/// findings: the file that was written, and names that it holds in another spelling. Throws as
/// need_label_table() and voxel::write_whole().
std::vector<std::string> write_label_table(const std::filesystem::path& label_map,
                                           const std::map<int, std::string>& names);

}  // namespace octotomy::planner
