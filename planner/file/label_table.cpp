// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/label_table.h"

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

#include "planner/file/name_text.h"
#include "planner/table/csv.h"
#include "planner/table/json.h"
#include "planner/table/json_file.h"
#include "planner/table/nearest_name.h"
#include "planner/table/number_format.h"
#include "voxel/scan/label_names.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// A label; "3.0" as tables of floats have it, too.
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

/// A whole number that is no label, such as -1 or 100000.
bool is_beyond_labels(const std::string& text) {
  std::string digits = voxel::trimmed(text);
  if (digits.ends_with(".0")) digits.resize(digits.size() - 2);
  const std::size_t first = digits.starts_with('-') || digits.starts_with('+') ? 1 : 0;
  return digits.size() > first && digits.find_first_not_of("0123456789", first) == std::string::npos &&
         !whole(text);
}

/// "0.5" or "1e3": a value and no name. Whole numbers can be names, as teeth have them.
bool is_decimal(const std::string& text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && !whole(text);
}

/// The names of labels while a table is read.
class Names {
 public:
  /// `where` is for refusals.
  void add(int label, const std::string& name, const std::string& where) {
    if (label == 0 || name.empty()) return;
    if (label < 0 || label > voxel::most_label)
      refuse(where, "must have a label from 0 to " + std::to_string(voxel::most_label));
    if (is_decimal(name)) refuse(where, "has the number " + name + " where a name should be");
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
      passed_over_.push_back(where + ": the row is passed over, as " + why);
  }
  bool empty() const { return names_.empty(); }
  LabelTable table(const fs::path& path) && {
    if (passed_over_count_ > passed_over_.size())
      passed_over_.push_back(path.string() + ": " + std::to_string(passed_over_count_ - passed_over_.size()) +
                             " more rows are passed over");
    return {std::move(names_), path, std::move(passed_over_)};
  }

 private:
  std::vector<std::string> passed_over_;
  std::size_t passed_over_count_ = 0;
  std::map<int, std::string> names_;
  std::map<std::string, int> labels_;
};

/// The value of the first of the keys that an object has; null where it has none.
const SortedJson* one_of(const SortedJson& object, const std::vector<const char*>& keys) {
  for (const char* key : keys)
    if (object.is_object() && object.contains(key)) return &object[key];
  return nullptr;
}

void add_json(Names& table, const SortedJson& json, const std::string& where) {
  if (json.is_array()) {
    for (const SortedJson& entry : json) {
      const std::string at = where + "[" + std::to_string(&entry - &json.front()) + "]";
      if (entry.is_array()) {  // dcmqi lists the segments of each file
        add_json(table, entry, at);
        continue;
      }
      const SortedJson* const label =
          one_of(entry, {"label", "labelID", "LabelValue", "value", "index", "id"});
      const SortedJson* const name = one_of(entry, {"name", "Name", "SegmentLabel"});
      const std::size_t number =
          count_of(label != nullptr ? *label : need(entry, "label", at), at + ".label");
      table.add(static_cast<int>(std::min(number, std::size_t{voxel::most_label} + 1)),
                word_of(name != nullptr ? *name : need(entry, "name", at), at + ".name"), at);
    }
    return;
  }
  if (!json.is_object()) refuse(where, "must be an object or a list of labels and names");
  if (const SortedJson* const inner = one_of(json, {"labels", "Labels", "LabelMap", "segmentAttributes"});
      inner != nullptr && inner->is_structured())
    return add_json(table, *inner, where + ": labels");
  for (const auto& [key, value] : json.items()) {
    const std::string at = where + ": " + key;
    if (const std::optional<int> label = whole(key); label && value.is_string())
      table.add(*label, value.get<std::string>(), at);
    else if (value.is_number_integer() && value >= 0 && value <= voxel::most_label)
      table.add(value.get<int>(), key, at);
    else if (value.is_array() && !value.empty() && value.front().is_number_integer())
      continue;  // nnU-Net's regions are unions of labels
    else
      refuse(at, "must be a name with its label, or a label with its name");
  }
}

/// Whether a key is the name of a number that files beside scans state of the acquisition (BIDS, dcm2niix):
/// one word of several parts in capitals, the last of which is a quantity.
bool is_of_acquisition(const std::string& key) {
  static const std::set<std::string> known{"KVP",
                                           "KVp",
                                           "Rows",
                                           "Columns",
                                           "Exposure",
                                           "ExposureInuAs",
                                           "Modality",
                                           "PixelBandwidth",
                                           "XRayTubeCurrent",
                                           "GantryDetectorTilt",
                                           "Resolution",
                                           "SAR",
                                           "BitsStored",
                                           "BitsAllocated",
                                           "HighBit",
                                           "SamplesPerPixel",
                                           "PixelRepresentation",
                                           "SmallestImagePixelValue",
                                           "LargestImagePixelValue",
                                           "WindowCenter",
                                           "WindowWidth",
                                           "RescaleSlope",
                                           "RescaleIntercept",
                                           "EchoTrainLength",
                                           "NumberOfAverages",
                                           "NumberOfFrames",
                                           "ReconMatrixPE",
                                           "PercentPhaseFOV",
                                           "PercentSampling",
                                           "ImagesInAcquisition"};
  if (known.contains(key)) return true;
  static const std::vector<std::string> quantities{
      "Number",    "Time",    "Thickness", "Angle",  "Spacing",  "Length",   "Width",    "Strength",
      "Frequency", "Factor",  "Size",      "Dose",   "Diameter", "Distance", "Height",   "Current",
      "Voltage",   "Tilt",    "Pitch",     "Rate",   "Steps",    "Delay",    "Duration", "Bandwidth",
      "Lines",     "Samples", "Averages",  "Slices", "Shift",    "Pixels"};
  const bool is_one_word =
      std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isalnum(c); });
  return is_one_word && std::any_of(quantities.begin(), quantities.end(), [&](const std::string& end) {
           return key.size() > end.size() && key.ends_with(end) &&
                  std::isupper(static_cast<unsigned char>(key.front()));
         });
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
  if (!whole(rows[0][0]) && !is_beyond_labels(rows[0][0])) {
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
    const auto cell = [&](std::size_t column) {
      return column < rows[i].size() ? voxel::trimmed(rows[i][column]) : std::string();
    };
    const std::string number = cell(label_at), name = cell(name_at);
    if (number.empty() || name.empty()) {
      table.pass_over(at, number.empty() ? "it has no label" : "label " + number + " has no name");
      continue;
    }
    if (is_beyond_labels(number)) {
      table.pass_over(at, "no label map can have the label " + number);
      continue;
    }
    const std::optional<int> label = whole(number);
    if (!label) refuse(at, "has no label from 0 to " + std::to_string(voxel::most_label) + " and a name");
    table.add(*label, name, at);
  }
}

/// "left kidney" of "left kidney 255 0 0 255": the words before a colour of three or four numbers; without
/// one those before the first number.
std::string name_before_colour(const std::string& text) {
  const auto is_number = [](const std::string& word) { return whole(word) || is_decimal(word); };
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  const auto most = std::min<std::ptrdiff_t>(std::ssize(words), 4);
  const auto colour = std::find_if_not(words.rbegin(), words.rbegin() + most, is_number) - words.rbegin();
  const auto end = colour >= 3 ? words.end() - colour : std::find_if(words.begin(), words.end(), is_number);
  std::string name;
  for (auto word = words.begin(); word != end; ++word) name += (name.empty() ? "" : " ") + *word;
  return name;
}

/// "Label Name R G B A", "#No. Label Name": two words and more, none of which is a number, one of them a
/// column's of labels.
bool is_heading(const std::string& text) {
  static const std::set<std::string> columns{"label", "index", "id", "idx", "no.", "no", "value"};
  std::istringstream in(text);
  bool any = false;
  std::size_t count = 0;
  for (std::string word; in >> word; ++count) {
    if (whole(word) || is_decimal(word) || is_beyond_labels(word)) return false;
    any = any || columns.contains(voxel::lower_case(word));
  }
  return any && count > 1;
}

/// "5 255 0 0 1 1 1 "liver"" of ITK-SNAP, "5 liver 255 0 0 255" of 3D Slicer and FreeSurfer.
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
      table.pass_over(at, "no label map can have the label " + word);
      continue;
    }
    const std::optional<int> label = whole(word);
    if (!label && may_be_heading && is_heading(text)) {
      table.pass_over(at, "it is a heading");
      continue;
    }
    if (!label || blank == std::string::npos)
      refuse(at, "begins with no label from 0 to " + std::to_string(voxel::most_label));
    const std::string rest = voxel::trimmed(text.substr(blank));
    const std::size_t quote = rest.find('"'), last = rest.rfind('"');
    const bool is_quoted = quote != last;
    std::string name = is_quoted ? rest.substr(quote + 1, last - quote - 1) : name_before_colour(rest);
    if (!is_quoted && name.empty()) refuse(at, "has a number and no name behind its label");
    // 3D Slicer writes an underscore for each blank.
    if (where.ends_with(".ctbl")) std::replace(name.begin(), name.end(), '_', ' ');
    table.add(*label, name, at);
  }
}

/// The parts of a BIDS name: "sub-01", "space-T1w", "dseg".
std::set<std::string> entities_of(const std::string& stem) {
  std::set<std::string> parts;
  std::istringstream in(stem);
  for (std::string part; std::getline(in, part, '_');) parts.insert(part);
  return parts;
}

/// The "dseg.tsv" of a folder and those above whose entities are all the label map's, the nearest and most
/// particular first.
std::vector<fs::path> inherited_tables(const fs::path& label_map, const std::string& stem) {
  std::vector<fs::path> found;
  const std::set<std::string> own = entities_of(stem);
  if (!own.contains("dseg")) return found;
  constexpr int most_folders = 4;
  fs::path folder = fs::absolute(label_map).parent_path();
  for (int i = 0; i < most_folders; ++i, folder = folder.parent_path()) {
    std::vector<std::pair<std::size_t, fs::path>> here;
    std::error_code unreadable;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable)) {
      const std::string name = entry.path().filename().string();
      if (!name.ends_with("dseg.tsv") || !entry.is_regular_file(unreadable)) continue;
      const std::set<std::string> parts = entities_of(entry.path().stem().string());
      if (std::includes(own.begin(), own.end(), parts.begin(), parts.end()) && parts != own)
        here.emplace_back(own.size() - parts.size(), entry.path());
    }
    std::sort(here.begin(), here.end());
    for (const auto& [distance, path] : here) found.push_back(path);
  }
  return found;
}

/// The files that may be a label map's table, the likeliest first.
std::vector<fs::path> tables_beside(const fs::path& label_map) {
  std::string stem = label_map.filename().string();
  for (const char* extension :
       {".nii.gz", ".nii", ".seg.nrrd", ".seg.nhdr", ".nrrd", ".nhdr", ".mha", ".mhd", ".img", ".hdr"})
    if (voxel::lower_case(stem).ends_with(extension)) {
      stem.resize(stem.size() - std::string(extension).size());
      break;
    }
  std::vector<std::string> extensions{".json", ".csv", ".tsv", ".txt", ".ctbl", ".label", ".lut"};
  // BIDS names labels in .tsv, and states other facts in .json.
  if (stem.ends_with("dseg")) std::swap(extensions[0], extensions[2]);
  std::vector<fs::path> found;
  for (const char* more : {"", "_labels", "-labels", "_ColorTable", "-ColorTable"})
    for (const std::string& extension : extensions)
      if (fs::path beside = label_map.parent_path() / (stem + more + extension); fs::is_regular_file(beside))
        found.push_back(std::move(beside));
  for (fs::path& table : inherited_tables(label_map, stem)) found.push_back(std::move(table));
  return found;
}

/// A table, or why the file is none of this label map's.
LabelTable table_or_why(const fs::path& path, const std::set<int>& occurring, std::string& why) {
  LabelTable table;
  try {
    table = read_label_table(path);
  } catch (const std::runtime_error& error) {
    why = error.what();
    if (why.starts_with(path.string() + ": ")) why.erase(0, path.string().size() + 2);
    return table;
  }
  const auto occurs = [&](const auto& entry) { return occurring.contains(entry.first); };
  if (table.names.empty())
    why = "it names no label";
  else if (!occurring.empty() && std::none_of(table.names.begin(), table.names.end(), occurs))
    why = "none of its labels occurs";
  if (voxel::extension_of(path) == ".json")
    for (const auto& [label, name] : table.names)
      if (is_of_acquisition(name)) why = "'" + name + "' is a number of an acquisition";
  return table;
}

/// A name or number that two tables give differently; empty where they agree.
std::string disagreement(const LabelTable& taken, const LabelTable& other) {
  std::map<std::string, int> numbers;
  for (const auto& [number, name] : other.names) numbers.emplace(name, number);
  for (const auto& [number, name] : taken.names) {
    if (const auto there = other.names.find(number); there != other.names.end() && there->second != name)
      return std::to_string(number) + " is '" + there->second + "' there and '" + name + "' here";
    if (const auto there = numbers.find(name); there != numbers.end() && there->second != number)
      return "'" + name + "' is " + std::to_string(there->second) + " there and " + std::to_string(number) +
             " here";
  }
  return {};
}

/// Reports tables in the label map's folder that contradict the one that is used.
void add_disagreements(const fs::path& label_map, const std::set<int>& occurring, LabelTable& taken) {
  for (const fs::path& beside : tables_beside(label_map)) {
    if (beside == taken.file || beside.parent_path() != label_map.parent_path()) continue;
    std::string why;
    const LabelTable other = table_or_why(beside, occurring, why);
    if (!why.empty()) continue;
    if (const std::string differs = disagreement(taken, other); !differs.empty())
      taken.passed_over.push_back(beside.string() + ": passed over, as it contradicts " +
                                  taken.file.string() + ", whose names are used: " + differs +
                                  "; remove the wrong one, or choose one by --names");
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
                              "', of the numbers " + list + ": choose one by its number, 'label'");
  }
  std::vector<std::string> known;
  for (const auto& [number, label] : names) known.push_back(label);
  if (known.empty())
    throw std::runtime_error("there is no label '" + name +
                             "': the label map has no names, and no table beside it that could be read has "
                             "them; say its number, or see what info says of the table");
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
    add_rows(table, extension == ".tsv" ? parse_tsv(text.utf8) : parse_csv(text.utf8), where);
  } else {
    std::istringstream lines(text.utf8);
    add_lines(table, lines, where);
  }
  LabelTable made = std::move(table).table(path);
  if (!text.encoding.empty())
    made.passed_over.insert(made.passed_over.begin(), where + ": read as " + text.encoding);
  return made;
}

LabelTable label_table_of(const fs::path& label_map, const std::set<int>& occurring) {
  if (LabelTable own{voxel::label_names(label_map), label_map}; !own.names.empty()) {
    add_disagreements(label_map, occurring, own);
    return own;
  }
  std::vector<std::string> passed_over;
  for (const fs::path& beside : tables_beside(label_map)) {
    std::string why;
    LabelTable table = table_or_why(beside, occurring, why);
    if (why.empty()) {
      table.passed_over.insert(table.passed_over.begin(), passed_over.begin(), passed_over.end());
      add_disagreements(label_map, occurring, table);
      return table;
    }
    passed_over.push_back(beside.string() + ": passed over, as it is no table of this label map's names: " +
                          why + "; --names takes a table as it is");
  }
  LabelTable none;
  none.passed_over = std::move(passed_over);
  return none;
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
  return {"labels are stored up to " + three_figures(off) +
          " off whole numbers, and taken as the nearest: " + numbers + (count > 8 ? " and more" : "")};
}

}  // namespace octotomy::planner
