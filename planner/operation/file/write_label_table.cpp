// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/write_label_table.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "planner/operation/file/label_table.h"
#include "planner/operation/file/output_path.h"
#include "voxel/space/file_text.h"
#include "voxel/space/write_whole.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// The names in a table; empty if the file cannot be read as a table.
std::map<int, std::string> names_in(const fs::path& table) {
  try {
    return read_label_table(table).names;
  } catch (const std::runtime_error&) {
    return {};
  }
}

/// The names in the spelling of label_table_text().
std::map<int, std::string> spelled(const std::map<int, std::string>& names) {
  std::map<std::string, int> count_of;
  std::map<int, std::string> made;
  for (const auto& [label, name] : names) {
    std::string plain = name;
    std::replace_if(
        plain.begin(), plain.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
    ++count_of[plain];
    made[label] = std::move(plain);
  }
  for (auto& [label, name] : made)
    if (count_of[name] > 1) name += " (label " + std::to_string(label) + ")";
  return made;
}

/// Whether Octotomy wrote a file: it is byte for byte the text that label_table_text() makes of its names.
bool is_written_here(const fs::path& table) {
  const std::map<int, std::string> names = names_in(table);
  if (names.empty() || !fs::is_regular_file(fs::symlink_status(table))) return false;
  std::ifstream in(table, std::ios::binary);
  return std::string{std::istreambuf_iterator<char>(in), {}} == label_table_text(names);
}

}  // namespace

bool holds_names(const fs::path& table, const std::map<int, std::string>& names) {
  const std::map<int, std::string> there = names_in(table);
  return there == names || there == spelled(names);
}

fs::path label_table_path(const fs::path& label_map) {
  std::string name = label_map.filename().string();
  if (voxel::extension_of(label_map) == ".gz") name.resize(name.size() - 3);
  fs::path table = label_map.parent_path() / name;
  if (voxel::lower_case(name).ends_with(".seg.nrrd")) table.replace_extension();
  return table.replace_extension(".tsv");
}

std::string label_table_text(const std::map<int, std::string>& names) {
  std::string text = "index\tname\n";
  for (const auto& [label, name] : spelled(names)) text += std::to_string(label) + "\t" + name + "\n";
  return text;
}

void need_label_table(const fs::path& label_map, const std::map<int, std::string>& names) {
  const fs::path table = label_table_path(label_map);
  if (!fs::exists(fs::symlink_status(table)) || holds_names(table, names)) return;
  if (fs::exists(label_map) && is_written_here(table)) return;
  throw std::runtime_error(table.string() +
                           ": is there already with other names than those of this label map's labels: move "
                           "it away, or choose another name for the label map");
}

std::vector<std::string> write_label_table(const fs::path& label_map,
                                           const std::map<int, std::string>& names) {
  if (label_table_of(label_map).names == names) return {};
  need_label_table(label_map, names);
  const fs::path table = label_table_path(label_map);
  if (!holds_names(table, names)) voxel::write_whole(table, label_table_text(names));
  std::vector<std::string> findings{"the names of the labels were written to " + table.string() +
                                    ", because the format of the label map has no place for them"};
  if (spelled(names) != names)
    findings.push_back(table.string() +
                       ": some names were changed: the label's number was added to a name of several labels, "
                       "and tabs and line breaks became blanks");
  if (label_table_of(label_map).names != spelled(names))
    findings.push_back(table.string() +
                       ": names change when they are read again: compare them with the source, and state the "
                       "names in another table by --names");
  return findings;
}

}  // namespace octotomy::planner
