// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/picture_statements.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"
#include "voxel/volume/frame_words.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 3> of_axis{"X", "Y", "Z"};

/// The text after a key, up to the closing quote or, without quotes, to the end of the line.
std::optional<std::string> words_behind(const std::string& text, const std::string& key) {
  const std::size_t found = text.find(key);
  if (found == std::string::npos) return std::nullopt;
  std::string_view rest = std::string_view(text).substr(found + key.size());
  const bool is_quoted = rest.starts_with('"') || rest.starts_with('\'');
  const char quote = is_quoted ? rest.front() : '\n';
  if (is_quoted) rest.remove_prefix(1);
  return trimmed(std::string(rest.substr(0, std::min(rest.find(quote), rest.find('\0')))));
}

/// "spacing=1.5", "SizeT=\"7\"".
std::optional<double> number_behind(const std::string& text, const std::string& key) {
  const std::optional<std::string> words = words_behind(text, key);
  if (!words) return std::nullopt;
  double number = 0.0;
  const auto [end, error] = std::from_chars(words->data(), words->data() + words->size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

/// A unit whose micro sign is converted to UTF-8. Java programs write this sign as \u00B5, older programs as
/// one byte.
std::string plain_unit(const std::string& word) {
  for (const std::string_view micro : {"\\u00B5", "\\u00b5", "\\u03BC", "\\u03bc", "\xb5"})
    if (word.starts_with(micro)) return "\u00b5" + word.substr(micro.size());
  constexpr std::size_t longest = 40;
  return shown(word.substr(0, longest));
}

bool is_near(double a, double b) {
  return std::abs(a - b) <= 0.01 * b;
}

/// Stores a size that the picture's program states, after conversion from the given unit to mm.
void take_size(StatedPicture& stated, std::size_t axis, std::optional<double> number,
               const std::string& unit) {
  if (!number) return;
  const std::optional<LengthUnit> length = length_unit(unit);
  if (!length)
    stated.not_sizes = "its unit '" + unit + "' is not a known unit of length";
  else if (!(*number > 0.0) || !std::isfinite(*number))
    stated.not_sizes = print("it states a size of %g %s", *number, unit.c_str());
  else
    stated.size_mm[axis] = *number * length->mm;
}

void read_image_j(const StoredImage& image, StatedPicture& stated) {
  const std::string& text = image.description;
  stated.program = "ImageJ";
  if (const auto word = words_behind(text, "\nunit=")) stated.unit = plain_unit(*word);
  const auto unit_of = [&](const char* key) {
    const auto word = words_behind(text, key);
    return word ? plain_unit(*word) : stated.unit;
  };
  const auto inverse = [](double per_unit) {
    return per_unit > 0.0 ? std::optional(1.0 / per_unit) : std::nullopt;
  };
  if (stated.unit.empty()) {
    stated.not_sizes = "its description names no unit";
  } else {
    take_size(stated, 0, inverse(image.pixels_per_unit), stated.unit);
    take_size(stated, 1, inverse(image.pixels_per_unit_across), unit_of("\nyunit="));
    take_size(stated, 2, number_behind(text, "\nspacing="), unit_of("\nzunit="));
  }
  // In the resolution tags ImageJ writes only the units inch and cm, and its description then states the same
  // unit.
  if (const auto unit = length_unit(stated.unit);
      unit && image.mm_per_unit > 0.0 && !is_near(image.mm_per_unit, unit->mm)) {
    stated.size_mm[0] = stated.size_mm[1] = std::nullopt;
    stated.not_sizes = print("its description is in %s and its resolution is not: another program changed it",
                             stated.unit.c_str());
  }
}

void read_ome(const StoredImage& image, StatedPicture& stated) {
  stated.program = "OME";
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string key = std::string("PhysicalSize") + of_axis[axis];
    const std::string unit = plain_unit(words_behind(image.description, key + "Unit=").value_or("\u00b5m"));
    const std::optional<double> size = number_behind(image.description, key + "=");
    take_size(stated, axis, size, unit);
    if (size && stated.unit.empty()) stated.unit = unit;
  }
  if (image.orientation >= 5) std::swap(stated.size_mm[0], stated.size_mm[1]);
}

/// Whether a resolution is a common one for print. Programs write these resolutions as defaults, so they do
/// not state a pixel's size.
bool is_of_print(double pixels_per_mm) {
  constexpr std::array<double, 6> per_inch{72.0, 96.0, 100.0, 150.0, 300.0, 600.0};
  return std::any_of(per_inch.begin(), per_inch.end(),
                     [&](double usual) { return std::abs(25.4 * pixels_per_mm - usual) < 0.1; });
}

/// "0.5 x 0.6 x ? mm".
std::string sizes_text(const StatedPicture& stated) {
  std::string text;
  for (const std::optional<double>& size : stated.size_mm)
    text += (text.empty() ? "" : " x ") + (size ? print("%.6g", *size) : "?");
  return text + " mm";
}

}  // namespace

StatedPicture stated_by(const StoredImage& image) {
  const std::string& text = image.description;
  StatedPicture stated;
  const auto add_axis = [&](const char* key, const char* what) {
    if (const auto count = number_behind(text, key); count && *count > 1.0 && stated.further_axis.empty())
      stated.further_axis = print("%g %s", *count, what);
  };
  if (text.starts_with("ImageJ=")) {
    read_image_j(image, stated);
    stated.images = number_behind(text, "\nimages=").value_or(1.0);
    add_axis("\nframes=", "times");
    add_axis("\nchannels=", "channels");
    const auto start = number_behind(text, "\nc0="), slope = number_behind(text, "\nc1=");
    if (slope && (start.value_or(0.0) != 0.0 || *slope != 1.0))
      stated.calibration = print("%g + %g times the grey value", start.value_or(0.0), *slope);
    for (const char* origin : {"\nxorigin=", "\nyorigin=", "\nzorigin="})
      stated.has_origin |= number_behind(text, origin).value_or(0.0) != 0.0;
  } else if (text.find("<OME") != std::string::npos) {
    read_ome(image, stated);
    add_axis("SizeT=", "times");
    add_axis("SizeC=", "channels");
  }
  if (image.mm_per_unit > 0.0 && image.pixels_per_unit > 0.0 && image.pixels_per_unit_across > 0.0 &&
      !is_of_print(image.pixels_per_unit / image.mm_per_unit))
    stated.page_mm = image.mm_per_unit / glm::dvec2(image.pixels_per_unit, image.pixels_per_unit_across);
  return stated;
}

void PictureStatements::add(const StoredImage& image, bool is_first_of_file) {
  ++count_;
  white_zero_ += image.is_white_zero;
  lossy_ += image.is_lossy;
  const StatedPicture stated = stated_by(image);
  if (count_ == 1) first_ = stated;
  // The description of the first page applies to the whole file.
  if (!is_first_of_file && stated.program.empty() && !first_.program.empty()) return;
  const auto differ = [](const std::optional<double>& a, const std::optional<double>& b) {
    return a.has_value() != b.has_value() || (a && !is_near(*a, *b));
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    differs_ = differs_ || differ(stated.size_mm[axis], first_.size_mm[axis]);
  if (!first_.program.empty()) return;
  differs_ = differs_ || stated.page_mm.has_value() != first_.page_mm.has_value() ||
             (stated.page_mm && !(is_near(stated.page_mm->x, first_.page_mm->x) &&
                                  is_near(stated.page_mm->y, first_.page_mm->y)));
}

KnownSpacing PictureStatements::spacing(const fs::path& path) const {
  const auto& size = first_.size_mm;
  const std::string advice = ": give --spacing X,Y,Z in mm";
  if (first_.program.empty()) refuse_without_spacing(path);
  if (differs_) refuse(path, "holds pictures that state different sizes of their pixels" + advice);
  if (!first_.not_sizes.empty())
    refuse(path,
           "does not state its spacing: " + first_.program + " wrote it, but " + first_.not_sizes + advice);
  if (!size[0] && !size[1] && !size[2]) refuse_without_spacing(path);
  std::string missing;
  const std::array<const char*, 3> what{"the width of a pixel", "the height of a pixel",
                                        "the distance of slices"};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!size[axis]) missing += (missing.empty() ? "" : ", ") + std::string(what[axis]);
  if (!missing.empty())
    refuse(path,
           "states a part of its spacing, " + sizes_text(first_) + " (" + first_.program + "), without " +
               missing +
               (!size[2] && first_.program == "ImageJ"
                    ? " (which ImageJ leaves out of single pictures, and where it is 1 " + first_.unit + ")"
                    : "") +
               advice);
  return {{*size[0], *size[1], *size[2]}, "mm (" + first_.program + "'s unit '" + first_.unit + "')"};
}

void PictureStatements::report(Scene& scene, bool is_stated) const {
  const auto warn = [&](const char* check, std::string text) {
    scene.audit.push_back({check, Verdict::Warn, std::move(text)});
  };
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  if (is_stated)
    scene.audit.push_back({"picture_spacing", Verdict::Pass,
                           sizes_text(first_) + " as the pictures state it, " +
                               (first_.program == "OME" ? "in OME's PhysicalSizeX, Y and Z"
                                                        : "in ImageJ's description and their resolution")});
  if (first_.images > static_cast<double>(count_))
    scene.audit.push_back(
        {"picture_count", Verdict::Fail,
         print("the file states %g images and %zu were found: ImageJ writes stacks larger than 4 GB as one "
               "picture followed by raw samples; save it as NIfTI or NRRD, or as one picture per slice",
               first_.images, count_)});
  std::array<std::optional<double>, 3> stated_mm = first_.size_mm;
  for (int axis = 0; axis < 2 && first_.page_mm; ++axis)
    if (auto& size = stated_mm[static_cast<std::size_t>(axis)]; !size) size = (*first_.page_mm)[axis];
  const std::array<const char*, 3> what{"pixels %.6g mm wide", "pixels %.6g mm high", "slices %.6g mm apart"};
  for (int axis = 0; axis < 3 && !is_stated; ++axis)
    if (const auto& size = stated_mm[static_cast<std::size_t>(axis)];
        size && !is_near(*size, spacing_mm[axis]))
      warn("picture_spacing", "the pictures state " + print(what[static_cast<std::size_t>(axis)], *size) +
                                  print(", but --spacing states %.6g mm, which is used", spacing_mm[axis]));
  if (differs_)
    warn("picture_spacing", "the pictures state different sizes of their pixels: one size is used for all");
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
    warn("polarity", print("%zu of %zu pictures state that 0 is white (WhiteIsZero): their numbers are used "
                           "as stored, so bright and dark may be exchanged",
                           white_zero_, count_));
  if (lossy_ > 0)
    warn("compression", print("%zu of %zu pictures lost values by JPEG's compression", lossy_, count_));
}

}  // namespace octotomy::voxel
