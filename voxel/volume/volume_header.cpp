// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/volume_header.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "voxel/space/file_text.h"
#include "voxel/space/printed.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

/// An upper bound of the number of bytes of samples that a file can contain after its header.
std::uintmax_t most_bytes(const fs::path& file, const SampleFiles& samples) {
  // The limit is above deflate's highest ratio, 1032 bytes in one.
  constexpr std::uintmax_t densest = 1100;
  const std::uintmax_t held = fs::file_size(file);
  const std::uintmax_t before =
      samples.file_at + (samples.encoding == SampleFiles::Encoding::Raw ? samples.byte_skip : 0);
  const std::uintmax_t left = held - std::min(held, samples.at_end ? 0 : before);
  switch (samples.encoding) {
    case SampleFiles::Encoding::Raw:
      return left;
    case SampleFiles::Encoding::Deflated:
      return left * densest;
    case SampleFiles::Encoding::Hex:
      return left / 2;
    case SampleFiles::Encoding::Text:  // a digit and a blank; the last number needs no blank
      return (left + 1) / 2 * bytes_of(samples.stored.type);
  }
  return 0;
}

void need_bytes(const fs::path& path, const glm::ivec3& dims, const SampleFiles& samples) {
  const std::uintmax_t sample_bytes = bytes_of(samples.stored.type);
  std::uintmax_t most = 0;
  for (const fs::path& file : samples.files) most += most_bytes(file, samples);
  std::uintmax_t left = most / sample_bytes;
  for (int axis = 0; axis < 3; ++axis) left /= static_cast<std::uintmax_t>(dims[axis]);
  if (left == 0)
    refuse(path, print("its header claims %d x %d x %d samples of %d bytes, more than its data can hold: the "
                       "data are cut short, or the header is damaged",
                       dims.x, dims.y, dims.z, static_cast<int>(sample_bytes)));
  const std::uintmax_t count = static_cast<std::uintmax_t>(dims.x) * static_cast<std::uintmax_t>(dims.y) *
                               static_cast<std::uintmax_t>(dims.z);
  if (count % samples.files.size() != 0)
    refuse(path, std::to_string(count) + " samples cannot be divided among its " +
                     std::to_string(samples.files.size()) +
                     " data files: compare their number with the header");
}

}  // namespace

std::optional<std::string> VolumeHeader::field(const std::string& name) const {
  const auto found = fields.find(name);
  return found == fields.end() ? std::nullopt : std::optional<std::string>(found->second);
}

const char* name_of(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::Nifti:
      return "NIfTI";
    case VolumeFormat::Nrrd:
      return "NRRD";
    case VolumeFormat::Meta:
      return "MetaImage";
  }
  return "";
}

std::optional<VolumeFormat> volume_format(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return VolumeFormat::Nifti;
  if (name.ends_with(".nrrd") || name.ends_with(".nhdr")) return VolumeFormat::Nrrd;
  if (name.ends_with(".mha") || name.ends_with(".mhd")) return VolumeFormat::Meta;
  return std::nullopt;
}

std::optional<VolumeFormat> readable_volume_format(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".hdr") || name.ends_with(".hdr.gz")) return VolumeFormat::Nifti;
  if ((name.ends_with(".img") || name.ends_with(".img.gz")) && nifti_pair(path)) return VolumeFormat::Nifti;
  return volume_format(path);
}

glm::ivec3 dims_of(const fs::path& path, const std::vector<double>& lengths) {
  glm::ivec3 dims(1);
  std::string all;
  for (std::size_t axis = 0; axis < lengths.size(); ++axis) {
    const double length = lengths[axis];
    all += print("%s%.15g", axis == 0 ? "" : " x ", length);
    if (!(length >= 1.0 && length <= std::numeric_limits<int>::max() && length == std::trunc(length)))
      refuse(path, "its header claims " + all + " samples");
    if (axis >= 3 && length > 1.0)
      refuse(path, "has more than three axes (" + all + "); extract one volume from it");
    if (axis < 3) dims[static_cast<int>(axis)] = static_cast<int>(length);
  }
  return dims;
}

Finding rescale_finding(const StoredSamples& stored, const std::string& says) {
  if (!stored.is_rescaled())
    return {"rescale", Verdict::Pass, "values are the stored numbers (" + says + ")"};
  constexpr double least_step = 0x1p-24;  // relative rounding error of single precision
  if (std::abs(stored.slope) < least_step * std::abs(stored.intercept))
    return {"rescale", Verdict::Warn,
            print("values are %.9g * stored + %.9g (", stored.slope, stored.intercept) + says +
                "): with so large an intercept single precision cannot represent the steps of the stored "
                "numbers"};
  return {"rescale", Verdict::Pass,
          print("values are %.9g * stored %c %.9g (", stored.slope, stored.intercept < 0.0 ? '-' : '+',
                std::abs(stored.intercept)) +
              says + ")"};
}

void take_padding(const std::optional<std::string>& text, VolumeHeader& header) {
  if (!text) return;
  double padding = 0.0;
  const char* const end = text->data() + text->size();
  const auto [rest, error] = std::from_chars(text->data(), end, padding);
  if (error == std::errc() && rest == end && std::isfinite(padding)) {
    header.padding = padding;
  } else {
    header.audit.push_back(
        {"padding", Verdict::Warn,
         "the file states a padding that is not a number: every sample counts as measured"});
  }
}

void add_third_axis(VolumeHeader& header) {
  StatedGeometry& geometry = header.geometry;
  const glm::dvec3 mm = geometry.mm_per_unit;
  const glm::dvec3 across =
      glm::cross(mm * glm::dvec3(geometry.file_from_voxel[0]), mm * glm::dvec3(geometry.file_from_voxel[1]));
  const double length = glm::length(across);
  geometry.file_from_voxel[2] =
      glm::dvec4((length > 0.0 ? across / length : glm::dvec3(0.0, 0.0, 1.0)) / mm, 0.0);
  header.audit.push_back({"slice_spacing", Verdict::Warn,
                          "a single slice of a file that does not state its thickness: 1 mm is assumed"});
}

void warn_of_minus_signs(const char* name, const std::vector<double>& spacings, VolumeHeader& header) {
  if (std::none_of(spacings.begin(), spacings.end(), [](double spacing) { return spacing < 0.0; })) return;
  header.audit.push_back({"spacing", Verdict::Warn,
                          std::string(name) + " has a minus sign, which a spacing cannot have: the axis is "
                                              "assumed to run backwards; check left and right"});
}

VolumeHeader read_volume_header(const fs::path& path, VolumeFormat format) {
  VolumeHeader header = format == VolumeFormat::Nifti  ? read_nifti_header(path)
                        : format == VolumeFormat::Nrrd ? read_nrrd_header(path)
                                                       : read_meta_header(path);
  glm::ivec3 stored = header.geometry.dims;
  stored.x *= header.layers;
  need_bytes(path, stored, header.samples);
  return header;
}

}  // namespace octotomy::voxel
