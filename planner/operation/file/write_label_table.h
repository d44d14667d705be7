// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

// Writes the names of a label map's labels to a table beside it, where label_table_of() finds them.
namespace octotomy::planner {

/// The path of the table: the label map's path with the extension .tsv.
std::filesystem::path label_table_path(const std::filesystem::path& label_map);

/// Whether a table has exactly these names, as they are or as label_table_text() spells them. False if the
/// file is not a label table.
bool holds_names(const std::filesystem::path& table, const std::map<int, std::string>& names);

/// The text of a table in BIDS form, with the columns index and name. Tabs and line breaks in names become
/// blanks. If several labels have the same name, each gets its number, for example "Bone (label 7)".
std::string label_table_text(const std::map<int, std::string>& names);

/// Throws std::runtime_error if a file at label_table_path() has other names, because a reader would use it
/// for the label map. Exception: a table that label_table_text() made may be replaced if the label map
/// exists, too, because the label map is then also replaced. Must be called before the label map is written.
void need_label_table(const std::filesystem::path& label_map, const std::map<int, std::string>& names);

/// Writes the table beside the label map, unless label_table_of() already returns these names. Returns
/// findings: the path of the table, and changes in the spelling of names. Throws as need_label_table() and
/// voxel::write_whole().
std::vector<std::string> write_label_table(const std::filesystem::path& label_map,
                                           const std::map<int, std::string>& names);

}  // namespace octotomy::planner
