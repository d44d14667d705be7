// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_image_stack.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "voxel/picture/slice_names.h"
#include "voxel/scan/image_file.h"
#include "voxel/scan/picture_statements.h"
#include "voxel/scan/read_raw.h"
#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 10> extensions{".tif", ".tiff", ".png", ".jpg", ".jpeg",
                                                      ".bmp", ".pgm",  ".exr", ".jp2", ".webp"};

bool is_image(const fs::path& path) {
  return std::find(extensions.begin(), extensions.end(), extension_of(path)) != extensions.end();
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

/// A sentence on files that seem to be missing; empty if none does. Files seem to be missing if the numbers
/// in most neighbouring names differ by the least step, but some differ by more.
std::string skipped(const SliceNames& names) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < names.files.size(); ++i) {
    const std::optional<double> below = names.number[i - 1], here = names.number[i];
    if (!below || !here || *here <= *below) return {};
    steps.push_back(*here - *below);
  }
  if (steps.empty()) return {};
  // Steps between decimal fractions differ by rounding errors.
  constexpr double near = 1.5;
  const double least = *std::min_element(steps.begin(), steps.end());
  const auto is_wider = [&](double step) { return step > near * least; };
  const auto wider = std::find_if(steps.begin(), steps.end(), is_wider);
  const auto usual =
      steps.size() - static_cast<std::size_t>(std::count_if(steps.begin(), steps.end(), is_wider));
  if (wider == steps.end() || 2 * usual <= steps.size()) return {};
  double missing = 0.0;
  for (const double step : steps) missing += std::round(step / least) - 1.0;
  const auto at = static_cast<std::size_t>(wider - steps.begin());
  return print("%.0f", missing) + " numbers are skipped, first between " +
         names.files[at].filename().string() + " and " + names.files[at + 1].filename().string() +
         ": if slices are missing there, the slices above are placed too low";
}

}  // namespace

std::vector<fs::path> image_files(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return ordered_by_name(files_in(path, "*")).files;
  if (fs::is_regular_file(path, error)) return is_image(path) ? std::vector{path} : std::vector<fs::path>{};
  const std::string pattern = path.filename().string();
  if (pattern.find_first_of("*?") == std::string::npos) return {};
  // Each star multiplies the time for matching by the length of the name.
  if (std::count(pattern.begin(), pattern.end(), '*') > 4)
    refuse(path, "has more than four * in its pattern; use fewer");
  return ordered_by_name(files_in(path.has_parent_path() ? path.parent_path() : fs::path("."), pattern))
      .files;
}

Scene read_image_stack(const fs::path& path, const ReadOptions& options) {
  const std::vector<fs::path> files = image_files(path);
  if (files.empty()) refuse(path, "matches no image");
  const std::string stacks = stacks_named(files);
  if (std::error_code error; !stacks.empty() && fs::is_directory(path, error))
    refuse(path, "holds the pictures of several stacks, whose names have the same numbers: " + stacks +
                     ": put each stack into its own folder, or name one by a pattern such as 'ct_*.png'");
  std::vector<char> bytes;
  glm::ivec3 dims(0);
  SampleType type = SampleType::UInt8;
  std::set<int> orientations;
  PictureStatements statements;
  for (std::size_t i = 0; i < files.size(); ++i) {
    options.progress.at(static_cast<double>(i) / static_cast<double>(files.size()));
    bool is_first = true;
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
      statements.add(image, std::exchange(is_first, false));
      bytes.insert(bytes.end(), image.bytes.begin(), image.bytes.end());
      ++dims.z;
    }
  }
  Scene scene;
  scene.source = path.string();
  const KnownSpacing spacing =
      options.spacing_mm ? KnownSpacing{*options.spacing_mm, given_spacing} : statements.spacing(path);
  place_without_frame(path, dims, spacing, options, scene);
  scene.audit.push_back({"slice_order", Verdict::Warn,
                         std::to_string(dims.z) + " slices of " + std::to_string(files.size()) +
                             " files in the order of the numbers in their names, from " +
                             files.front().filename().string() + " to " + files.back().filename().string()});
  const SliceNames names = ordered_by_name(files);
  for (const std::string& doubt : names.doubts) scene.audit.push_back({"slice_names", Verdict::Warn, doubt});
  if (!stacks.empty())
    scene.audit.push_back({"stacks", Verdict::Fail,
                           "the pattern matches the pictures of several stacks, whose names have the same "
                           "numbers, as slices of one: " +
                               stacks + ": use a pattern that matches only one of them"});
  else if (const std::string alike = numbered_alike(names); !alike.empty())
    scene.audit.push_back({"stacks", Verdict::Warn, alike});
  if (const std::string missing = skipped(names); !missing.empty())
    scene.audit.push_back({"missing_slices", Verdict::Warn, missing});
  if (orientations != std::set{1})
    scene.audit.push_back({"picture_orientation", orientations.size() == 1 ? Verdict::Pass : Verdict::Warn,
                           orientations.size() == 1
                               ? "the pictures state the orientation " +
                                     std::to_string(*orientations.begin()) +
                                     ": they were turned upright by it"
                               : "the pictures state different orientations: each was turned upright by its "
                                 "own; check that all slices lie alike"});
  statements.report(scene, !options.spacing_mm);
  StoredSamples stored{type, std::endian::native == std::endian::big};
  take_bytes(bytes, stored, scene);
  return scene;
}

}  // namespace octotomy::voxel
