// SPDX-License-Identifier: AGPL-3.0-or-later
// Which file beside a label map, or above it, is the table of its labels' names; label_table.cpp reads it.
#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "planner/operation/file/label_table.h"
#include "voxel/scan/label_names.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// Whether a key is a quantity of an acquisition, because JSON files beside scans state those (BIDS,
/// dcm2niix). Such a key is one of a fixed list, or a single capitalised word that ends in a quantity, such
/// as "SliceThickness".
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

/// The parts of a BIDS name between underscores, such as "sub-01", "space-T1w" and "dseg".
std::set<std::string> entities_of(const std::string& stem) {
  std::set<std::string> parts;
  std::istringstream in(stem);
  for (std::string part; std::getline(in, part, '_');) parts.insert(part);
  return parts;
}

/// The files "*dseg.tsv" in the label map's folder and the three folders above, if all their entities occur
/// in the label map's name. The nearest folder comes first; within a folder, the file with most entities.
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

/// The files that may be a label map's table, likeliest first.
std::vector<fs::path> tables_beside(const fs::path& label_map) {
  std::string stem = label_map.filename().string();
  for (const char* extension :
       {".nii.gz", ".nii", ".seg.nrrd", ".seg.nhdr", ".nrrd", ".nhdr", ".mha", ".mhd", ".img", ".hdr"})
    if (voxel::lower_case(stem).ends_with(extension)) {
      stem.resize(stem.size() - std::string(extension).size());
      break;
    }
  std::vector<std::string> extensions{".json", ".csv", ".tsv", ".txt", ".ctbl", ".label", ".lut"};
  // BIDS stores labels' names in .tsv and other facts in .json, so .tsv comes first.
  if (stem.ends_with("dseg")) std::swap(extensions[0], extensions[2]);
  std::vector<fs::path> found;
  for (const char* more : {"", "_labels", "-labels", "_ColorTable", "-ColorTable"})
    for (const std::string& extension : extensions)
      if (fs::path beside = label_map.parent_path() / (stem + more + extension); fs::is_regular_file(beside))
        found.push_back(std::move(beside));
  for (fs::path& table : inherited_tables(label_map, stem)) found.push_back(std::move(table));
  return found;
}

/// Reads a table. If the file is not this label map's table, sets `why` to the reason.
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
      if (is_of_acquisition(name)) why = "'" + name + "' is a quantity of a scan's acquisition, not a name";
  return table;
}

/// The first name or label in which two tables differ, in words; empty if they agree.
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

/// Appends a finding on each table in the label map's folder that contradicts the table in use.
void add_disagreements(const fs::path& label_map, const std::set<int>& occurring, LabelTable& taken) {
  for (const fs::path& beside : tables_beside(label_map)) {
    if (beside == taken.file || beside.parent_path() != label_map.parent_path()) continue;
    std::string why;
    const LabelTable other = table_or_why(beside, occurring, why);
    if (!why.empty()) continue;
    if (const std::string differs = disagreement(taken, other); !differs.empty())
      taken.passed_over.push_back(beside.string() + ": is not used, because it contradicts " +
                                  taken.file.string() + ", whose names are used: " + differs +
                                  "; remove the wrong table, or choose one by --names");
  }
}

}  // namespace

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
    passed_over.push_back(beside.string() +
                          ": is not used, because it is not a table of this label map's names: " + why +
                          "; to use it without this check, name it by --names");
  }
  LabelTable none;
  none.passed_over = std::move(passed_over);
  return none;
}

LabelTable names_of_labels(const voxel::Scene& scene, const fs::path& file) {
  std::error_code unreadable;
  if (scene.meaning != voxel::Meaning::Label || !fs::is_regular_file(file, unreadable)) return {};
  std::set<int> occurring;
  try {
    for (const voxel::Label& label : voxel::labels(scene)) occurring.insert(label.number);
  } catch (const voxel::InvalidInput&) {  // samples between labels
    return {};
  }
  return label_table_of(file, occurring);
}

}  // namespace octotomy::planner
