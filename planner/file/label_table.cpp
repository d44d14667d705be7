// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/label_table.h"

#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "planner/table/csv.h"
#include "planner/table/json.h"
#include "planner/table/json_file.h"
#include "planner/table/nearest_name.h"
#include "voxel/scan/label_names.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;
std::optional<int> whole(const std::string& text) {
  const std::string digits = voxel::trimmed(text);
  int number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || number < 0 || number > 32767)
    return std::nullopt;
  return number;
}

/// The names of labels while a table is read.
class Names {
 public:
  /// `where` is for refusals.
  void add(int label, const std::string& name, const std::string& where) {
    if (label == 0 || name.empty()) return;
    const auto [own, is_new_label] = names_.emplace(label, name);
    if (!is_new_label)
      refuse(where,
             "label " + std::to_string(label) + " has two names, '" + own->second + "' and '" + name + "'");
    const auto [known, is_new_name] = labels_.emplace(name, label);
    if (!is_new_name)
      refuse(where, "'" + name + "' is the name of two labels, " + std::to_string(known->second) + " and " +
                        std::to_string(label));
  }
  std::map<int, std::string> all() && { return std::move(names_); }

 private:
  std::map<int, std::string> names_;
  std::map<std::string, int> labels_;
};

void add_json(Names& table, const SortedJson& json, const std::string& where) {
  if (json.is_array()) {
    for (const SortedJson& entry : json) {
      const std::string at = where + "[" + std::to_string(&entry - &json.front()) + "]";
      table.add(static_cast<int>(count_of(need(entry, "label", at), at + ".label")),
                word_of(need(entry, "name", at), at + ".name"), at);
    }
    return;
  }
  if (!json.is_object()) refuse(where, "must be an object or a list of labels and names");
  if (json.contains("labels")) return add_json(table, json["labels"], where + ": labels");
  for (const auto& [key, value] : json.items()) {
    const std::string at = where + ": " + key;
    if (const std::optional<int> label = whole(key); label && value.is_string())
      table.add(*label, value.get<std::string>(), at);
    else if (value.is_number_integer() && value >= 0 && value <= 32767)
      table.add(value.get<int>(), key, at);
    else
      refuse(at, "must be a name with its label, or a label with its name");
  }
}

/// The column whose heading is one of the words; none where there is none.
std::optional<std::size_t> column(const std::vector<std::string>& heading,
                                  const std::vector<std::string>& words) {
  for (const std::string& word : words)
    for (std::size_t i = 0; i < heading.size(); ++i)
      if (voxel::lower_case(voxel::trimmed(heading[i])) == word) return i;
  return std::nullopt;
}

void add_rows(Names& table, const std::vector<std::vector<std::string>>& rows, const std::string& where) {
  if (rows.empty()) return;
  std::size_t label_at = 0, name_at = 1, first = 0;
  if (!whole(rows[0][0])) {
    const auto labels = column(rows[0], {"label", "labelvalue", "label_value", "value", "index", "id"});
    const auto names = column(rows[0], {"name", "labelname", "label_name", "segmentname", "structure"});
    if (!labels || !names)
      refuse(where + ":1", "must name a column 'label' and a column 'name', or begin with a label");
    label_at = *labels;
    name_at = *names;
    first = 1;
  }
  for (std::size_t i = first; i < rows.size(); ++i) {
    const std::string at = where + ":" + std::to_string(i + 1);
    const std::optional<int> label = label_at < rows[i].size() ? whole(rows[i][label_at]) : std::nullopt;
    if (!label || name_at >= rows[i].size()) refuse(at, "has no label from 0 to 32767 and a name");
    table.add(*label, voxel::trimmed(rows[i][name_at]), at);
  }
}

/// "5 255 0 0 1 1 1 "liver"" of ITK-SNAP, "5 liver 255 0 0 255" of 3D Slicer.
void add_lines(Names& table, std::istream& in, const std::string& where) {
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const std::string text = voxel::trimmed(line), at = where + ":" + std::to_string(number);
    if (text.empty() || text[0] == '#') continue;
    const std::size_t blank = text.find_first_of(" \t");
    const std::optional<int> label = whole(text.substr(0, blank));
    if (!label || blank == std::string::npos) refuse(at, "begins with no label from 0 to 32767");
    const std::string rest = voxel::trimmed(text.substr(blank));
    const std::size_t quote = rest.find('"'), last = rest.rfind('"');
    table.add(
        *label,
        quote != last ? rest.substr(quote + 1, last - quote - 1) : rest.substr(0, rest.find_first_of(" \t")),
        at);
  }
}

}  // namespace

int LabelTable::label(const std::string& name) const {
  for (const auto& [number, label] : names)
    if (label == name) return number;
  std::vector<std::string> known;
  for (const auto& [number, label] : names) known.push_back(label);
  if (known.empty())
    throw std::runtime_error("there is no label '" + name +
                             "': neither the label map nor a table beside it has names; say its number");
  throw std::runtime_error(file.string() + ": has no label '" + name + "'" + suggestion(name, known));
}

LabelTable read_label_table(const fs::path& path) {
  Names table;
  const std::string extension = voxel::extension_of(path), where = path.string();
  if (extension == ".json") {
    add_json(table, read_json(path), where);
    return {std::move(table).all(), path};
  }
  std::ifstream in = voxel::opened(path);
  if (!in) refuse(where, "cannot be read");
  if (extension == ".csv" || extension == ".tsv") {
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (extension == ".tsv")
      for (char& letter : text)
        if (letter == '\t') letter = ',';
    add_rows(table, parse_csv(text), where);
  } else {
    add_lines(table, in, where);
  }
  return {std::move(table).all(), path};
}

LabelTable label_table_of(const fs::path& label_map) {
  if (LabelTable own{voxel::label_names(label_map), label_map}; !own.names.empty()) return own;
  std::string stem = label_map.filename().string();
  for (const char* extension : {".nii.gz", ".nii", ".seg.nrrd", ".nrrd", ".nhdr", ".mha", ".mhd"})
    if (voxel::lower_case(stem).ends_with(extension)) {
      stem.resize(stem.size() - std::string(extension).size());
      break;
    }
  for (const char* more : {"", "_labels", "-labels"})
    for (const char* extension : {".json", ".csv", ".tsv", ".txt", ".ctbl"})
      if (const fs::path beside = label_map.parent_path() / (stem + more + extension);
          fs::is_regular_file(beside))
        return read_label_table(beside);
  return {};
}

}  // namespace octotomy::planner
