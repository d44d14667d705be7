// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_image_stack.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "voxel/scan/image_file.h"
#include "voxel/scan/read_raw.h"
#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/volume/frame_words.h"

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

/// A file's name with # in the place of each number, and its numbers, zeros before them left out.
struct NumberedName {
  std::string pattern, numbers;
};
NumberedName numbered_name(const fs::path& file) {
  NumberedName made;
  const std::string name = file.filename().string();
  const fs::path stem = file.stem();
  for (std::size_t at = 0; at < name.size();) {
    if (at >= stem.string().size() || !is_digit(name[at])) {
      made.pattern += name[at++];
      continue;
    }
    std::size_t end = at;
    while (end < name.size() && is_digit(name[end])) ++end;
    while (at + 1 < end && name[at] == '0') ++at;
    made.pattern += '#';
    made.numbers += name.substr(at, end - at) + ' ';
    at = end;
  }
  return made;
}

/// The stacks of files whose names differ by more than numbers and have the same numbers: "ct_#.png (5
/// files) and mask_#.png (5 files)". Empty where the names are those of one stack.
std::string stacks_named(const std::vector<fs::path>& files) {
  std::map<std::string, std::set<std::string>> patterns_of;  // by numbers
  std::map<std::string, std::size_t> count_of;               // by pattern
  for (const fs::path& file : files) {
    const NumberedName name = numbered_name(file);
    if (!name.numbers.empty()) patterns_of[name.numbers].insert(name.pattern);
    ++count_of[name.pattern];
  }
  std::set<std::string> doubled;
  for (const auto& [numbers, patterns] : patterns_of)
    if (patterns.size() > 1) doubled.insert(patterns.begin(), patterns.end());
  std::string text;
  std::size_t named = 0;
  constexpr std::size_t most_named = 3;
  for (const std::string& pattern : doubled) {
    if (++named > most_named) return text + " and " + std::to_string(doubled.size() - most_named) + " more";
    const std::size_t count = count_of[pattern];
    text += (named == 1                ? ""
             : named == doubled.size() ? " and "
                                       : ", ") +
            pattern + " (" + std::to_string(count) + (count == 1 ? " file)" : " files)");
  }
  return text;
}

/// A sentence on names that have the same last numbers behind different numbers ("s1_000" and "s2_000"):
/// stacks in one folder, or the blocks of one stack. Empty where the last numbers are those of one stack.
std::string numbered_alike(const std::vector<fs::path>& files) {
  std::map<std::string, std::set<long>> numbers_of;  // by what stands before the last number
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    const std::size_t last = stem.find_last_of("0123456789");
    const std::size_t before = last == std::string::npos ? last : stem.find_last_not_of("0123456789", last);
    if (const std::optional<long> number = number_in(file); number && before != std::string::npos)
      numbers_of[stem.substr(0, before + 1)].insert(*number);
  }
  const std::set<long>* first = nullptr;
  std::string first_name;
  for (const auto& [name, numbers] : numbers_of) {
    const auto is_first_too = [&](long number) { return first->contains(number); };
    if (numbers.size() < 2) continue;
    if (first == nullptr) {
      first = &numbers;
      first_name = name;
    } else if (std::count_if(numbers.begin(), numbers.end(), is_first_too) > 1) {
      return "names that begin with '" + first_name + "' and with '" + name +
             "' have the same last numbers, and their pictures are taken as slices of one stack: if they are "
             "several, put each into a folder of its own";
    }
  }
  return {};
}

/// The number behind a key in a description: "spacing=1.5", "SizeT=\"7\"".
std::optional<double> number_behind(const std::string& text, const std::string& key) {
  std::size_t at = text.find(key);
  if (at == std::string::npos) return std::nullopt;
  at += key.size();
  if (at < text.size() && text[at] == '"') ++at;
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data() + at, text.data() + text.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

/// What ImageJ and OME write into a picture's description, and the picture's own resolution.
struct StatedPicture {
  std::optional<double> pixel_mm, slice_mm;
  std::string further_axis;  ///< "7 times"
  std::string calibration;   ///< of grey values, as ImageJ states it: "-1024 + 1 g, HU"
  bool has_origin = false;
  double images = 1.0;  ///< in the file
};
StatedPicture stated_by(const StoredImage& image) {
  const std::string& text = image.description;
  StatedPicture stated;
  const auto unit_mm = [&](const std::string& key) -> std::optional<double> {
    const std::size_t at = text.find(key);
    if (at == std::string::npos) return std::nullopt;
    std::string_view word = std::string_view(text).substr(at + key.size());
    if (word.starts_with('"')) word.remove_prefix(1);
    word = word.substr(0, word.find_first_of(" \"\r\n"));
    const std::optional<LengthUnit> unit = length_unit(std::string(word));
    return unit ? std::optional(unit->mm) : std::nullopt;
  };
  const auto add_axis = [&](const char* key, const char* what) {
    if (const auto count = number_behind(text, key); count && *count > 1.0 && stated.further_axis.empty())
      stated.further_axis = print("%g %s", *count, what);
  };
  if (text.starts_with("ImageJ=")) {
    if (const auto mm = unit_mm("\nunit=")) {
      if (image.pixels_per_unit > 0.0) stated.pixel_mm = *mm / image.pixels_per_unit;
      if (const auto spacing = number_behind(text, "\nspacing=")) stated.slice_mm = *mm * *spacing;
    }
    stated.images = number_behind(text, "\nimages=").value_or(1.0);
    add_axis("\nframes=", "times");
    add_axis("\nchannels=", "channels");
    const auto start = number_behind(text, "\nc0="), slope = number_behind(text, "\nc1=");
    if (slope && (start.value_or(0.0) != 0.0 || *slope != 1.0))
      stated.calibration = print("%g + %g times the grey value", start.value_or(0.0), *slope);
    for (const char* origin : {"\nxorigin=", "\nyorigin=", "\nzorigin="})
      stated.has_origin |= number_behind(text, origin).value_or(0.0) != 0.0;
  } else if (text.find("<OME") != std::string::npos) {
    const double mm = unit_mm("PhysicalSizeXUnit=").value_or(1e-3);  // micrometres, by OME's definition
    if (const auto size = number_behind(text, "PhysicalSizeX=")) stated.pixel_mm = *size * mm;
    const double slice_mm = unit_mm("PhysicalSizeZUnit=").value_or(1e-3);
    if (const auto size = number_behind(text, "PhysicalSizeZ=")) stated.slice_mm = *size * slice_mm;
    add_axis("SizeT=", "times");
    add_axis("SizeC=", "channels");
  }
  // Print resolutions that programs write by default state no pixel's size.
  const double per_inch = 25.4 * image.pixels_per_mm;
  constexpr std::array<double, 6> of_print{72.0, 96.0, 100.0, 150.0, 300.0, 600.0};
  const bool is_of_print = std::any_of(of_print.begin(), of_print.end(),
                                       [&](double usual) { return std::abs(per_inch - usual) < 0.1; });
  if (!stated.pixel_mm && image.pixels_per_mm > 0.0 && !is_of_print)
    stated.pixel_mm = 1.0 / image.pixels_per_mm;
  return stated;
}

/// Holds what pictures state about themselves against how they are read.
class PictureAudit {
 public:
  void add(const StoredImage& image) {
    ++count_;
    white_zero_ += image.is_white_zero;
    lossy_ += image.is_lossy;
    StatedPicture stated = stated_by(image);
    if (count_ == 1) first_ = stated;
    differs_ = differs_ || stated.pixel_mm.has_value() != first_.pixel_mm.has_value() ||
               (stated.pixel_mm && !is_near(*stated.pixel_mm, *first_.pixel_mm));
  }
  void report(Scene& scene) const {
    const auto warn = [&](const char* check, std::string text) {
      scene.audit.push_back({check, Verdict::Warn, std::move(text)});
    };
    const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
    if (first_.images > static_cast<double>(count_))
      scene.audit.push_back(
          {"picture_count", Verdict::Fail,
           print(
               "the file states %g images and %zu were found: ImageJ writes stacks over 4 GB as one picture "
               "with the others behind it; save it as NIfTI or NRRD, or a picture a slice",
               first_.images, count_)});
    if (first_.pixel_mm && !is_near(*first_.pixel_mm, spacing_mm.x))
      warn("picture_spacing",
           print("the pictures state pixels of %.6g mm, and %.6g mm is taken as --spacing gives it",
                 *first_.pixel_mm, spacing_mm.x));
    if (first_.slice_mm && !is_near(*first_.slice_mm, spacing_mm.z))
      warn("picture_spacing",
           print("the pictures state slices %.6g mm apart, and %.6g mm is taken as --spacing gives it",
                 *first_.slice_mm, spacing_mm.z));
    if (differs_)
      warn("picture_spacing", "the pictures state different sizes of their pixels: one is taken for all");
    if (!first_.further_axis.empty())
      warn("picture_axes",
           "the pictures state " + first_.further_axis + ", which are read as slices: export one volume");
    if (!first_.calibration.empty())
      warn("picture_values", "the pictures state that a value is " + first_.calibration +
                                 ": their numbers are taken as stored, without it");
    if (first_.has_origin)
      warn("picture_origin",
           "the pictures state an origin, in pixels of their own: it is not used, the volume's centre is the "
           "origin");
    if (white_zero_ > 0)
      warn("polarity",
           print("%zu of %zu pictures state that 0 is white (WhiteIsZero): their numbers are taken as "
                 "stored, so that bright and dark may be exchanged",
                 white_zero_, count_));
    if (lossy_ > 0)
      warn("compression", print("%zu of %zu pictures lost values by JPEG's compression", lossy_, count_));
  }

 private:
  static bool is_near(double a, double b) { return std::abs(a - b) <= 0.01 * b; }
  std::size_t count_ = 0, white_zero_ = 0, lossy_ = 0;
  bool differs_ = false;
  StatedPicture first_;
};

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
  const std::string stacks = stacks_named(files);
  if (std::error_code error; !stacks.empty() && fs::is_directory(path, error))
    refuse(path,
           "holds the pictures of several stacks, whose names have the same numbers: " + stacks +
               ": put each stack into a folder of its own, or name one by a pattern such as 'ct_*.png'");
  std::vector<char> bytes;
  glm::ivec3 dims(0);
  SampleType type = SampleType::UInt8;
  std::set<int> orientations;
  PictureAudit statements;
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
      statements.add(image);
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
  if (!stacks.empty())
    scene.audit.push_back({"stacks", Verdict::Fail,
                           "the pattern takes the pictures of several stacks, whose names have the same "
                           "numbers, as slices of one: " +
                               stacks + ": let it name one of them"});
  else if (const std::string alike = numbered_alike(files); !alike.empty())
    scene.audit.push_back({"stacks", Verdict::Warn, alike});
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
  statements.report(scene);
  StoredSamples stored{type, std::endian::native == std::endian::big};
  take_bytes(bytes, stored, scene);
  return scene;
}

}  // namespace octotomy::voxel
