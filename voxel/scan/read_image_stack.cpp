// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_image_stack.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <optional>
#include <set>

#include "voxel/scan/image_file.h"
#include "voxel/scan/read_raw.h"
#include "voxel/space/file_text.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 10> extensions{".tif", ".tiff", ".png", ".jpg", ".jpeg",
                                                      ".bmp", ".pgm",  ".exr", ".jp2", ".webp"};

bool is_image(const fs::path& path) {
  return std::find(extensions.begin(), extensions.end(), extension_of(path)) != extensions.end();
}

bool is_digit(char c) {
  return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

/// Orders names with their digits read as numbers: slice2 comes before slice10.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const auto number = [](const std::string& text, std::size_t& at) {
        while (at < text.size() && text[at] == '0') ++at;
        const std::size_t start = at;
        while (at < text.size() && is_digit(text[at])) ++at;
        return text.substr(start, at - start);
      };
      const std::string first = number(a, i);
      const std::string second = number(b, j);
      if (first.size() != second.size()) return first.size() < second.size();
      if (first != second) return first < second;
      continue;
    }
    if (a[i] != b[j]) return a[i] < b[j];
    ++i;
    ++j;
  }
  return a.size() - i < b.size() - j;
}

/// Whether a name matches a pattern of * (any letters) and ? (one letter).
bool matches(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*')
    return matches(pattern.substr(1), name) || (!name.empty() && matches(pattern, name.substr(1)));
  return !name.empty() && (pattern.front() == '?' || pattern.front() == name.front()) &&
         matches(pattern.substr(1), name.substr(1));
}

std::vector<fs::path> files_in(const fs::path& folder, const std::string& pattern) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error))
    if (std::error_code ignored; entry->is_regular_file(ignored) && is_image(entry->path()) &&
                                 matches(pattern, entry->path().filename().string()))
      files.push_back(entry->path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  return files;
}

SampleType sample_type_of(const StoredImage& image) {
  switch (image.type) {
    case StoredImage::Type::UInt8:
      return SampleType::UInt8;
    case StoredImage::Type::UInt16:
      return SampleType::UInt16;
    case StoredImage::Type::Int16:
      return SampleType::Int16;
    case StoredImage::Type::Float:
      break;
  }
  return SampleType::Float;
}

/// The last number in a file's name; none where it has no digit or more than a slice's number takes.
std::optional<long> number_in(const fs::path& file) {
  const std::string name = file.stem().string();
  const auto last = std::find_if(name.rbegin(), name.rend(), is_digit);
  const auto before = std::find_if_not(last, name.rend(), is_digit);
  const std::string digits(before.base(), last.base());
  if (digits.empty() || digits.size() > 9) return std::nullopt;
  return std::stol(digits);
}

/// A sentence on files that seem to be missing: the numbers in most names are the least step apart, and some
/// are further. Empty where none seems to be missing.
std::string skipped(const std::vector<fs::path>& files) {
  std::vector<long> steps;
  for (std::size_t i = 1; i < files.size(); ++i) {
    const std::optional<long> below = number_in(files[i - 1]), here = number_in(files[i]);
    if (!below || !here || *here <= *below) return {};
    steps.push_back(*here - *below);
  }
  if (steps.empty()) return {};
  const long least = *std::min_element(steps.begin(), steps.end());
  const auto wider = std::find_if(steps.begin(), steps.end(), [&](long step) { return step > least; });
  const auto usual = static_cast<std::size_t>(std::count(steps.begin(), steps.end(), least));
  if (wider == steps.end() || 2 * usual <= steps.size()) return {};
  long missing = 0;
  for (const long step : steps) missing += step / least - 1;
  const auto at = static_cast<std::size_t>(wider - steps.begin());
  return std::to_string(missing) + " numbers are skipped, first between " + files[at].filename().string() +
         " and " + files[at + 1].filename().string() +
         ": if slices are missing there, those above them lie too low";
}

}  // namespace

std::vector<fs::path> image_files(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return files_in(path, "*");
  if (fs::is_regular_file(path, error)) return is_image(path) ? std::vector{path} : std::vector<fs::path>{};
  const std::string pattern = path.filename().string();
  if (pattern.find_first_of("*?") == std::string::npos) return {};
  // Each star multiplies the time of matching by the length of the name.
  if (std::count(pattern.begin(), pattern.end(), '*') > 4)
    refuse(path, "has more than four * in its pattern; use fewer");
  return files_in(path.has_parent_path() ? path.parent_path() : fs::path("."), pattern);
}

Scene read_image_stack(const fs::path& path, const ReadOptions& options) {
  const std::vector<fs::path> files = image_files(path);
  if (files.empty()) refuse(path, "matches no image");
  std::vector<char> bytes;
  glm::ivec3 dims(0);
  SampleType type = SampleType::UInt8;
  std::set<int> orientations;
  for (std::size_t i = 0; i < files.size(); ++i) {
    options.progress.at(static_cast<double>(i) / static_cast<double>(files.size()));
    for (const StoredImage& image : read_images(files[i])) {
      if (dims.z == 0) {
        dims = {image.width, image.height, 0};
        type = sample_type_of(image);
      }
      if (glm::ivec2(image.width, image.height) != glm::ivec2(dims) || sample_type_of(image) != type)
        refuse(files[i], "differs in size or type of pixels from the images before it, which are " +
                             std::to_string(dims.x) + " x " + std::to_string(dims.y) +
                             ": put each stack into a folder of its own");
      orientations.insert(image.orientation);
      bytes.insert(bytes.end(), image.bytes.begin(), image.bytes.end());
      ++dims.z;
    }
  }
  Scene scene;
  scene.source = path.string();
  place_without_frame(path, dims, options, scene);
  scene.audit.push_back({"slice_order", Verdict::Warn,
                         std::to_string(dims.z) + " slices of " + std::to_string(files.size()) +
                             " files in the order of the numbers in their names, from " +
                             files.front().filename().string() + " to " + files.back().filename().string()});
  if (const std::string missing = skipped(files); !missing.empty())
    scene.audit.push_back({"missing_slices", Verdict::Warn, missing});
  if (orientations != std::set{1})
    scene.audit.push_back({"picture_orientation", orientations.size() == 1 ? Verdict::Pass : Verdict::Warn,
                           orientations.size() == 1
                               ? "the pictures state the orientation " +
                                     std::to_string(*orientations.begin()) +
                                     ": they were turned upright by it"
                               : "the pictures state different orientations: each was turned upright by its "
                                 "own; check that all slices lie alike"});
  StoredSamples stored{type, std::endian::native == std::endian::big};
  take_bytes(bytes, stored, scene);
  return scene;
}

}  // namespace octotomy::voxel
