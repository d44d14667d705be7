// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/label_names.h"

#include <charconv>
#include <fstream>

#include "voxel/scan/dicom_file.h"
#include "voxel/scan/read_dicom_seg.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

std::map<int, std::string> of_dicom(const fs::path& path) {
  const std::string bytes = file_bytes(path);
  std::map<int, std::string> names;
  try {
    const DicomFile file(bytes, bytes.size());
    for (const DicomFile& segment : file.items(0x00620002))
      names[segment.unsigned_short(0x00620004).value_or(0)] = trimmed(segment.readable_text(0x00620005));
  } catch (const DicomFile::Deflated&) {
    refuse(path, "a deflated segmentation: inflate it first");
  } catch (const DicomFile::NeedsMore&) {
    refuse(path, "a segmentation that is cut short");
  } catch (const Error& error) {
    refuse(path, error.what());
  }
  names.erase(0);
  return names;
}

/// Slicer's segments by their number in the header, whose lines are KEY:=VALUE up to an empty one.
std::map<int, std::string> of_nrrd(const fs::path& path) {
  struct Segment {
    std::string name;
    int label = 0;
  };
  std::map<int, Segment> segments;
  std::ifstream in = opened(path);
  constexpr std::size_t most_lines = 100000;
  std::string line;
  for (std::size_t i = 0; i < most_lines && std::getline(in, line) && !trimmed(line).empty(); ++i) {
    const std::size_t middle = line.find(":=");
    if (!line.starts_with("Segment") || middle == std::string::npos) continue;
    int number = 0;
    const char* const end = line.data() + middle;
    const auto [rest, error] = std::from_chars(line.data() + 7, end, number);
    if (error != std::errc()) continue;
    const std::string key(rest, end), value = trimmed(line.substr(middle + 2));
    if (key == "_Name") segments[number].name = value;
    if (key == "_LabelValue")
      std::from_chars(value.data(), value.data() + value.size(), segments[number].label);
  }
  std::map<int, std::string> names;
  // Without a value the segments are numbered as they are listed.
  for (const auto& [number, segment] : segments)
    if (!segment.name.empty()) names.emplace(segment.label > 0 ? segment.label : number + 1, segment.name);
  return names;
}

}  // namespace

std::map<int, std::string> label_names(const fs::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".nrrd" || extension == ".nhdr") return of_nrrd(path);
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && is_dicom_seg(path) ? of_dicom(path)
                                                                  : std::map<int, std::string>{};
}

}  // namespace octotomy::voxel
