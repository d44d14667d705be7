// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/label_names.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <set>
#include <utility>

#include "voxel/dicom/dicom_file.h"
#include "voxel/scan/read_dicom_seg.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

std::map<int, std::string> of_dicom(const fs::path& path) {
  std::map<int, std::string> names;
  std::string stored = file_bytes(path);
  try {
    const std::string bytes = whole_dicom(std::move(stored));
    const DicomFile file(bytes, bytes.size(), true);
    for (const DicomFile& segment : file.items(0x00620002))
      names[segment.unsigned_short(0x00620004).value_or(0)] = trimmed(segment.readable_text(0x00620005));
  } catch (const DicomFile::NeedsMore&) {
    refuse(path, "a segmentation that is cut short");
  } catch (const Error& error) {
    refuse(path, error.what());
  }
  names.erase(0);
  return names;
}

}  // namespace

std::vector<SlicerSegment> slicer_segments(const fs::path& path) {
  std::map<int, SlicerSegment> listed;
  bool has_layers = false, states_layers = false;
  std::ifstream in = opened(path);
  constexpr std::size_t most_lines = 100000;
  std::string line;
  for (std::size_t i = 0; i < most_lines && std::getline(in, line) && !trimmed(line).empty(); ++i) {
    const std::size_t middle = line.find(":=");
    if (line.starts_with("dimension:")) has_layers = trimmed(line.substr(10)) != "3";
    if (!line.starts_with("Segment") || middle == std::string::npos) continue;
    int number = 0;
    const char* const end = line.data() + middle;
    const auto [rest, error] = std::from_chars(line.data() + 7, end, number);
    constexpr int most_segments = 1000000;
    if (error != std::errc() || number < 0 || number > most_segments) continue;
    const std::string key(rest, end), value = trimmed(line.substr(middle + 2));
    const auto whole = [&](int& to) { std::from_chars(value.data(), value.data() + value.size(), to); };
    SlicerSegment& segment = listed[number];
    if (key == "_Name") segment.name = value;
    if (key == "_LabelValue") whole(segment.value);
    if (key == "_Layer") whole(segment.layer);
    states_layers = states_layers || key == "_Layer" || key == "_LabelValue";
  }
  std::vector<SlicerSegment> segments;
  int largest = 0;
  for (auto& [number, segment] : listed) {
    if (segment.name.empty()) continue;
    if (!has_layers) {
      segment.layer = 0;
    } else if (!states_layers) {
      // 3D Slicer 4 to 4.10 wrote a layer of zeros and ones for each segment.
      segment.layer = number;
      segment.value = 1;
    }
    // Segments without a value are numbered in the order of the list.
    if (segment.value <= 0) segment.value = number + 1;
    largest = std::max(largest, segment.value);
    segments.push_back(std::move(segment));
  }
  std::set<int> taken;
  std::map<std::pair<int, int>, int> number_of;  // the label's number for each pair of layer and value
  for (SlicerSegment& segment : segments) {
    const auto [known, is_new] = number_of.try_emplace({segment.layer, segment.value}, segment.value);
    if (is_new && taken.contains(segment.value)) known->second = ++largest;
    segment.number = known->second;
    taken.insert(segment.number);
  }
  return segments;
}

std::map<int, std::string> label_names(const fs::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".nrrd" || extension == ".nhdr") {
    std::map<int, std::string> names;
    for (const SlicerSegment& segment : slicer_segments(path)) {
      std::string& name = names[segment.number];
      name += (name.empty() ? "" : " + ") + segment.name;
    }
    return names;
  }
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && is_dicom_seg(path) ? of_dicom(path)
                                                                  : std::map<int, std::string>{};
}

}  // namespace octotomy::voxel
