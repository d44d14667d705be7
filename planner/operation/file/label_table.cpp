// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/label_table.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "planner/operation/file/name_text.h"
#include "planner/operation/table/csv.h"
#include "planner/operation/table/json.h"
#include "planner/operation/table/json_file.h"
#include "planner/operation/table/nearest_name.h"
#include "planner/operation/table/number_format.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// The label in a text; none if it is not a whole number that a label can have. "3.0" counts as 3, because
/// some tables store labels as floats.
std::optional<int> whole(const std::string& text) {
  std::string digits = voxel::trimmed(text);
  if (digits.ends_with(".0")) digits.resize(digits.size() - 2);
  int number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || number < 0 ||
      number > voxel::most_label)
    return std::nullopt;
  return number;
}

/// Whether a text is a whole number that cannot be a label, such as -1 or 100000.
bool is_beyond_labels(const std::string& text) {
  std::string digits = voxel::trimmed(text);
  if (digits.ends_with(".0")) digits.resize(digits.size() - 2);
  const std::size_t first = digits.starts_with('-') || digits.starts_with('+') ? 1 : 0;
  return digits.size() > first && digits.find_first_not_of("0123456789", first) == std::string::npos &&
         !whole(text);
}

/// Whether a text is a number with a fraction or an exponent, such as "0.5" or "1e3". Such a text is not a
/// name, but a whole number can be one, for example of a tooth.
bool is_decimal(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && !whole(text);
}

/// The labels and names read so far, with remarks on rows that were left out.
class Names {
 public:
  /// `where` is for refusals.
  void add(int label, const std::string& name, const std::string& where) {
    if (label == 0 || name.empty()) return;
    if (label < 0 || label > voxel::most_label)
      refuse(where, "must have a label from 0 to " + std::to_string(voxel::most_label));
    if (is_decimal(name)) refuse(where, "has the number " + name + " in the place of a name");
    const auto [own, is_new_label] = names_.emplace(label, name);
    if (!is_new_label)
      refuse(where,
             "label " + std::to_string(label) + " has two names, '" + own->second + "' and '" + name + "'");
    const auto [known, is_new_name] = labels_.emplace(name, label);
    if (!is_new_name)
      refuse(where, "'" + name + "' is the name of two labels, " + std::to_string(known->second) + " and " +
                        std::to_string(label));
  }
  /// Leaves a row out.
  void pass_over(const std::string& where, const std::string& why) {
    constexpr std::size_t most_told = 8;
    if (++passed_over_count_ <= most_told)
      passed_over_.push_back(where + ": the row is left out, because " + why);
  }
  /// Adds a finding that concerns the whole table.
  void note(std::string text) { notes_.push_back(std::move(text)); }
  LabelTable table(const fs::path& path) && {
    if (passed_over_count_ > passed_over_.size())
      passed_over_.push_back(path.string() + ": " + std::to_string(passed_over_count_ - passed_over_.size()) +
                             " more rows are left out");
    passed_over_.insert(passed_over_.begin(), notes_.begin(), notes_.end());
    return {std::move(names_), path, std::move(passed_over_)};
  }

 private:
  std::vector<std::string> passed_over_, notes_;
  std::size_t passed_over_count_ = 0;
  std::map<int, std::string> names_;
  std::map<std::string, int> labels_;
};

/// A heading or key reduced to lower-case letters and digits, because programs spell headings differently:
/// "Label Value", "LabelValue" and "label_value" become "labelvalue"; "#No." becomes "no".
std::string plain_word(const std::string& text) {
  std::string word;
  for (const unsigned char c : text)
    if (std::isalnum(c)) word += static_cast<char>(std::tolower(c));
  return word;
}

/// Column headings and JSON keys of labels in plain_word() spelling, likeliest first.
const std::vector<std::string>& words_of_labels() {
  static const std::vector<std::string> words{
      "label",  "labelvalue", "labelid", "labelnumber", "labelno",   "labelindex", "value",   "index", "id",
      "number", "no",         "idx",     "key",         "segmentid", "segmentno",  "classid", "class"};
  return words;
}

/// Column headings and JSON keys of names in plain_word() spelling, likeliest first. A column "label" can
/// contain the names if another column contains the labels.
const std::vector<std::string>& words_of_names() {
  static const std::vector<std::string> words{
      "name",        "labelname",  "segmentname", "segmentlabel", "structurename",
      "structure",   "regionname", "classname",   "class",        "labeldescription",
      "description", "anatomy",    "region",      "organ",        "label"};
  return words;
}

/// The value of the first key in `words` that the object has and whose value passes `fits`; null if there is
/// none.
template <typename Fits>
const SortedJson* one_of(const SortedJson& object, const std::vector<std::string>& words, const Fits& fits) {
  if (!object.is_object()) return nullptr;
  for (const std::string& word : words)
    for (const auto& [key, value] : object.items())
      if (plain_word(key) == word && fits(value)) return &value;
  return nullptr;
}

/// The text of a JSON string or number; empty for other values.
std::string number_text(const SortedJson& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number()) return value.dump();
  return {};
}

bool is_label_number(const SortedJson& value) {
  const std::string text = number_text(value);
  return whole(text) || is_beyond_labels(text);
}

/// Adds an entry of a JSON list, such as {"label": 5, "name": "liver"} or {"id": 5, "label": "liver"}.
void add_entry(Names& table, const SortedJson& entry, const std::string& at) {
  const SortedJson* const label = one_of(entry, words_of_labels(), is_label_number);
  const SortedJson* const name = one_of(
      entry, words_of_names(), [&](const SortedJson& value) { return &value != label && value.is_string(); });
  if (label == nullptr) {
    const SortedJson* const none =
        one_of(entry, words_of_labels(), [](const SortedJson& value) { return value.is_null(); });
    if (none != nullptr && name != nullptr) return table.pass_over(at, "it has no label");
    refuse(at, "has no label: add a key 'label' with a whole number and a key 'name'");
  }
  const std::string number = number_text(*label);
  if (is_beyond_labels(number)) return table.pass_over(at, "labels cannot have the number " + number);
  if (name == nullptr) word_of(need(entry, "name", at), at + ".name");
  if (name == nullptr || voxel::trimmed(name->get<std::string>()).empty())
    return table.pass_over(at, "label " + number + " has no name");
  table.add(*whole(number), name->get<std::string>(), at);
}

void add_json(Names& table, const SortedJson& json, const std::string& where) {
  if (json.is_array()) {
    for (const SortedJson& entry : json) {
      const std::string at = where + "[" + std::to_string(&entry - &json.front()) + "]";
      if (entry.is_array())  // dcmqi writes one list of segments for each file
        add_json(table, entry, at);
      else
        add_entry(table, entry, at);
    }
    return;
  }
  if (!json.is_object()) refuse(where, "must be a JSON object or a list of labels and names");
  for (const char* const key : {"labels", "Labels", "LabelMap", "segmentAttributes"})
    if (json.contains(key) && json[key].is_structured())
      return add_json(table, json[key], where + ": labels");
  for (const auto& [key, value] : json.items()) {
    const std::string at = where + ": " + key;
    const std::string number = value.is_number() ? value.dump() : "";
    if (const std::optional<int> label = whole(key); label && value.is_string())
      table.add(*label, value.get<std::string>(), at);
    else if (is_beyond_labels(key) && value.is_string())
      table.pass_over(at, "labels cannot have the number " + key);
    else if (const std::optional<int> own = whole(number))
      table.add(*own, key, at);
    else if (is_beyond_labels(number))
      table.pass_over(at, "labels cannot have the number " + number);
    else if (value.is_array() && !value.empty() && value.front().is_number_integer())
      continue;  // a region of nnU-Net, which is a union of labels
    else
      refuse(at, "must be a name and its label, or a label and its name");
  }
}

using Rows = std::vector<std::vector<std::string>>;

std::string cell_of(const std::vector<std::string>& row, std::size_t column) {
  return column < row.size() ? voxel::trimmed(row[column]) : std::string();
}

/// The columns whose heading is one of the words, in the order of the words.
std::vector<std::size_t> columns_of(const std::vector<std::string>& heading,
                                    const std::vector<std::string>& words) {
  std::vector<std::size_t> found;
  for (const std::string& word : words)
    for (std::size_t i = 0; i < heading.size(); ++i)
      if (plain_word(heading[i]) == word) found.push_back(i);
  return found;
}

/// Whether a column can be the one of labels, in the rows from `first`: at least one cell is a whole number,
/// or all cells are empty. A column of words has no labels.
bool may_have_labels(const Rows& rows, std::size_t first, std::size_t column) {
  bool any = false;
  for (std::size_t i = first; i < rows.size(); ++i) {
    const std::string text = cell_of(rows[i], column);
    if (whole(text) || is_beyond_labels(text)) return true;
    any = any || !text.empty();
  }
  return !any;
}

/// Whether all non-empty cells of a column are whole numbers, in the rows from `first`.
bool has_numbers(const Rows& rows, std::size_t first, std::size_t column) {
  return std::all_of(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), [&](const auto& row) {
    const std::string text = cell_of(row, column);
    return text.empty() || whole(text) || is_beyond_labels(text);
  });
}

struct Columns {
  std::size_t label = 0, name = 1, first_row = 0;
};

/// Finds the columns of labels and of names. In a .tsv the column "index" has the labels (BIDS), even if
/// other columns have numbers. Adds a finding on a further column of labels with other numbers.
Columns columns_in(Names& table, const Rows& rows, const std::string& where, bool is_tsv) {
  if (whole(rows[0][0]) || is_beyond_labels(rows[0][0])) {
    const bool has_words = std::any_of(rows.begin(), rows.end(), [](const auto& row) {
      return std::any_of(row.begin() + 1, row.end(), [](const std::string& text) {
        return !text.empty() && !whole(text) && !is_beyond_labels(text) && !is_decimal(text);
      });
    });
    if (rows[0].size() > 2 && has_words && has_numbers(rows, 0, 1))
      refuse(where + ":1",
             "has numbers in its second column, where names are expected without a heading: add a first row "
             "that names a column 'label' and a column 'name'");
    return {};
  }
  std::vector<std::size_t> labels = columns_of(rows[0], words_of_labels());
  if (is_tsv)
    std::stable_partition(labels.begin(), labels.end(),
                          [&](std::size_t column) { return plain_word(rows[0][column]) == "index"; });
  const auto numbered = std::find_if(labels.begin(), labels.end(),
                                     [&](std::size_t column) { return may_have_labels(rows, 1, column); });
  std::vector<std::size_t> names = columns_of(rows[0], words_of_names());
  if (!labels.empty()) {
    const std::size_t taken = numbered != labels.end() ? *numbered : labels.front();
    std::erase(names, taken);
    if (!names.empty()) {
      for (const std::size_t other : labels) {
        if (other == taken || other == names.front() || !has_numbers(rows, 1, other)) continue;
        const auto differs = std::find_if(rows.begin() + 1, rows.end(), [&](const auto& row) {
          return !cell_of(row, other).empty() && cell_of(row, other) != cell_of(row, taken);
        });
        if (differs != rows.end())
          table.note(where + ": WARN: the labels are read from the column '" +
                     voxel::trimmed(rows[0][taken]) + "'; the column '" + voxel::trimmed(rows[0][other]) +
                     "' has other numbers and is ignored");
      }
      return {taken, names.front(), 1};
    }
  }
  refuse(where + ":1",
         "must be a heading with the columns 'label' and 'name', or a row that begins with a label");
}

void add_rows(Names& table, const Rows& rows, const std::string& where, bool is_tsv) {
  if (rows.empty()) return;
  const Columns columns = columns_in(table, rows, where, is_tsv);
  for (std::size_t i = columns.first_row; i < rows.size(); ++i) {
    const std::string at = where + ":" + std::to_string(i + 1);
    const std::string number = cell_of(rows[i], columns.label), name = cell_of(rows[i], columns.name);
    if (number.empty() || name.empty()) {
      table.pass_over(at, number.empty() ? "it has no label" : "label " + number + " has no name");
      continue;
    }
    if (is_beyond_labels(number)) {
      table.pass_over(at, "labels cannot have the number " + number);
      continue;
    }
    const std::optional<int> label = whole(number);
    if (!label)
      refuse(at, "must have a label from 0 to " + std::to_string(voxel::most_label) + " and a name");
    table.add(*label, name, at);
  }
}

/// The name in the rest of a line, without its colour. In "left kidney 255 0 0 255" the words before a colour
/// of three or four numbers are the name; without a colour, the words before the first number. In FSL's "0.9
/// 0.9 0.9 left kidney", the words after the colour are the name.
std::string name_before_colour(const std::string& text) {
  const auto is_number = [](const std::string& word) { return whole(word) || is_decimal(word); };
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  const auto most = std::min<std::ptrdiff_t>(std::ssize(words), 4);
  const auto colour = std::find_if_not(words.rbegin(), words.rbegin() + most, is_number) - words.rbegin();
  auto end = colour >= 3 ? words.end() - colour : std::find_if(words.begin(), words.end(), is_number);
  auto begin = words.begin();
  if (end == begin) {  // the colour comes first
    begin = std::find_if_not(words.begin(), words.end(), is_number);
    if (begin - words.begin() < 3) return {};
    end = words.end();
  }
  std::string name;
  for (auto word = begin; word != end; ++word) name += (name.empty() ? "" : " ") + *word;
  return name;
}

/// Whether a line is a heading, such as "Label Name R G B A" or "#No. Label Name": it has at least two
/// words, none of them is a number, and one of them heads a column of labels.
bool is_heading(const std::string& text) {
  const std::vector<std::string>& columns = words_of_labels();
  std::istringstream in(text);
  bool any = false;
  std::size_t count = 0;
  for (std::string word; in >> word; ++count) {
    if (whole(word) || is_decimal(word) || is_beyond_labels(word)) return false;
    any = any || std::find(columns.begin(), columns.end(), plain_word(word)) != columns.end();
  }
  return any && count > 1;
}

/// Reads lines of ITK-SNAP, such as "5 255 0 0 1 1 1 "liver"", and of 3D Slicer and FreeSurfer, such as "5
/// liver 255 0 0 255".
void add_lines(Names& table, std::istream& in, const std::string& where) {
  std::string line;
  bool is_first = true;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    const std::string text = voxel::trimmed(line), at = where + ":" + std::to_string(number);
    if (text.empty() || text[0] == '#') continue;
    const std::size_t blank = text.find_first_of(" \t");
    const std::string word = text.substr(0, blank);
    const bool may_be_heading = std::exchange(is_first, false);
    if (is_beyond_labels(word)) {
      table.pass_over(at, "labels cannot have the number " + word);
      continue;
    }
    const std::optional<int> label = whole(word);
    if (!label && may_be_heading && is_heading(text)) {
      table.pass_over(at, "it is a heading");
      continue;
    }
    if (!label || blank == std::string::npos)
      refuse(at, "must begin with a label from 0 to " + std::to_string(voxel::most_label));
    const std::string rest = voxel::trimmed(text.substr(blank));
    const std::size_t quote = rest.find('"'), last = rest.rfind('"');
    const bool is_quoted = quote != last;
    std::string name = is_quoted ? rest.substr(quote + 1, last - quote - 1) : name_before_colour(rest);
    if (!is_quoted && name.empty()) refuse(at, "has only numbers after its label: write the name there");
    // 3D Slicer's .ctbl files have underscores in place of blanks.
    if (where.ends_with(".ctbl")) std::replace(name.begin(), name.end(), '_', ' ');
    table.add(*label, name, at);
  }
}

}  // namespace

int LabelTable::label(const std::string& name) const {
  std::vector<int> numbers;
  for (const auto& [number, label] : names)
    if (composed(label) == composed(name)) numbers.push_back(number);
  if (numbers.size() == 1) return numbers.front();
  if (!numbers.empty()) {
    std::string list;
    for (const int number : numbers) list += (list.empty() ? "" : ", ") + std::to_string(number);
    refuse(file.string(), "has " + std::to_string(numbers.size()) + " labels '" + name +
                              "', with the numbers " + list + ": choose one of them by its number, 'label'");
  }
  std::vector<std::string> known;
  for (const auto& [number, label] : names) known.push_back(label);
  if (known.empty())
    throw std::runtime_error("there is no label '" + name +
                             "': neither the label map nor a table beside it has names: state the label's "
                             "number, or read what octotomy info reports on tables beside the label map");
  throw std::runtime_error(file.string() + ": has no label '" + name + "'" + suggestion(name, known));
}

LabelTable read_label_table(const fs::path& path) {
  Names table;
  const std::string extension = voxel::extension_of(path), where = path.string();
  if (extension == ".json") {
    add_json(table, read_json(path), where);
    return std::move(table).table(path);
  }
  std::ifstream in = voxel::opened(path);
  if (!in) refuse(where, "cannot be read");
  const DecodedText text = decoded({std::istreambuf_iterator<char>(in), {}});
  if (extension == ".csv" || extension == ".tsv") {
    const bool is_tsv = extension == ".tsv";
    add_rows(table, is_tsv ? parse_tsv(text.utf8) : parse_csv(text.utf8), where, is_tsv);
  } else {
    std::istringstream lines(text.utf8);
    add_lines(table, lines, where);
  }
  LabelTable made = std::move(table).table(path);
  if (!text.encoding.empty())
    made.passed_over.insert(made.passed_over.begin(), where + ": read as " + text.encoding);
  return made;
}

std::vector<std::string> findings_of_labels(const std::vector<voxel::Label>& labels) {
  double off = 0.0;
  std::string numbers;
  std::size_t count = 0;
  for (const voxel::Label& label : labels) {
    if (label.off == 0.0) continue;
    off = std::max(off, label.off);
    constexpr std::size_t most = 8;
    if (++count <= most) numbers += (numbers.empty() ? "" : ", ") + std::to_string(label.number);
  }
  if (count == 0) return {};
  return {"labels are stored as fractions, up to " + three_figures(off) +
          " from a whole number, and rounded to the nearest: " + numbers + (count > 8 ? " and more" : "")};
}

}  // namespace octotomy::planner
