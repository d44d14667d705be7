// SPDX-License-Identifier: AGPL-3.0-or-later
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include "voxel/dicom_file.h"
#include "voxel/dicom_values.h"
#include "voxel/staging.h"
#include "voxel/write_scene.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "values are written as they stand in memory");

constexpr const char* ct_image_storage = "1.2.840.10008.5.1.4.1.1.2";
constexpr const char* mr_image_storage = "1.2.840.10008.5.1.4.1.1.4";

/// Attributes in ascending order, encoded with explicit VR, little-endian (DICOM PS3.5, 7.1).
class Attributes {
 public:
  void put(DicomTag tag, const char* vr, std::string_view value) {
    Value& put = values_[tag];
    put.vr = vr;
    put.bytes = value;
  }
  /// Padded to an even length as the value representation asks.
  void text(DicomTag tag, const char* vr, std::string value) {
    if (value.size() % 2 == 1) value.push_back(std::string_view(vr) == "UI" ? '\0' : ' ');
    put(tag, vr, value);
  }
  void number(DicomTag tag, std::uint16_t value) {
    put(tag, "US", {reinterpret_cast<const char*>(&value), sizeof value});
  }
  void remove(DicomTag tag) { values_.erase(tag); }
  void sequence(DicomTag tag, const std::vector<Attributes>& items) {
    std::string bytes;
    for (const Attributes& item : items) {
      const std::string inside = item.encoded();
      const auto length = static_cast<std::uint32_t>(inside.size());
      bytes += std::string("\xfe\xff\x00\xe0", 4);
      bytes.append(reinterpret_cast<const char*>(&length), sizeof length);
      bytes += inside;
    }
    put(tag, "SQ", bytes);
  }

  std::string encoded() const {
    std::string bytes;
    const auto append = [&](std::uint32_t number, std::size_t width) {
      bytes.append(reinterpret_cast<const char*>(&number), width);
    };
    for (const auto& [tag, value] : values_) {
      append(tag >> 16, 2);
      append(tag & 0xffffu, 2);
      bytes += value.vr;
      const bool is_wide = value.vr == "OB" || value.vr == "OW" || value.vr == "SQ";
      if (is_wide) append(0, 2);
      append(static_cast<std::uint32_t>(value.bytes.size()), is_wide ? 4 : 2);
      bytes += value.bytes;
    }
    return bytes;
  }

 private:
  struct Value {
    std::string vr;
    std::string bytes;
  };
  std::map<DicomTag, Value> values_;
};

/// One series: what its slices share, and a slice's file.
class SeriesWriter {
 public:
  SeriesWriter(const Scene& scene, const DicomOptions& options) : scene_(scene), options_(options) {
    check(scene);
    check_text(options.patient_name, "patient_name");
    check_text(options.series_description, "series_description");
    const glm::dmat4& lps_from_voxel = scene.lattice.lps_from_voxel;
    spacing_mm_ = scene.lattice.spacing_mm();
    along_row_ = glm::dvec3(lps_from_voxel[0]) / spacing_mm_.x;
    along_column_ = glm::dvec3(lps_from_voxel[1]) / spacing_mm_.y;
    // ImageOrientationPatient's own rounding, 13 decimals at worst, is far below; single precision is not.
    if (std::abs(glm::dot(along_row_, along_column_)) > 1e-6)
      throw std::invalid_argument(
          "a DICOM slice's rows and columns must be perpendicular: resample the scene");
    if (scene.lattice.dims.x > 65535 || scene.lattice.dims.y > 65535)
      throw std::invalid_argument("a DICOM slice has at most 65535 rows and columns");
    step_mm_ = std::abs(glm::dot(glm::dvec3(lps_from_voxel[2]), glm::cross(along_row_, along_column_)));
    digest_.add(&lps_from_voxel, sizeof lps_from_voxel);
    digest_.add(&scene.lattice.dims, sizeof scene.lattice.dims);
    std::visit([&](const auto& samples) { digest_.add(samples.data(), samples.size() * sizeof samples[0]); },
               scene.samples);
    digest_.add(options.patient_name);
    digest_.add(options.series_description);
    if (options.source) digest_.add(options.source->series_uid);
    is_mr_ = scene.modality == "MR";
  }

  /// Writes slice k to `path`; `name` is what errors call it.
  void write(int k, const fs::path& path, const fs::path& name) const {
    const Int16Samples samples = samples_of(k);
    Attributes slice;
    put_patient_and_study(slice);
    if (is_mr_) put_acquisition(slice);
    if (options_.source) put_source(slice, *options_.source, k);
    put_image(slice, k);
    put_pixels(slice, samples);
    std::ofstream out(path, std::ios::binary);
    out << std::string(128, '\0') << "DICM" << meta_of(k).encoded() << slice.encoded();
    out.close();
    if (!out) throw std::runtime_error(name.string() + ": cannot be written; check the space left");
  }

 private:
  static void check_text(const std::string& text, const char* name) {
    if (text.size() > 64 || text.find('\\') != std::string::npos)
      throw std::invalid_argument(std::string(name) + " '" + text +
                                  "' must have at most 64 characters and no backslash");
  }

  Int16Samples samples_of(int k) const {
    const std::size_t area =
        static_cast<std::size_t>(scene_.lattice.dims.x) * static_cast<std::size_t>(scene_.lattice.dims.y);
    Int16Samples slice(area);
    std::visit(
        [&](const auto& samples) {
          for (std::size_t i = 0; i < area; ++i) {
            const auto value = static_cast<double>(samples[static_cast<std::size_t>(k) * area + i]);
            if (!(value >= std::numeric_limits<std::int16_t>::min() &&
                  value <= std::numeric_limits<std::int16_t>::max() && value == std::trunc(value)))
              throw std::invalid_argument("sample " + std::to_string(value) + " of slice " +
                                          std::to_string(k) +
                                          " is no integer of int16's range: round or rescale the scene");
            slice[i] = static_cast<std::int16_t>(value);
          }
        },
        scene_.samples);
    return slice;
  }

  const char* storage() const { return is_mr_ ? mr_image_storage : ct_image_storage; }
  std::string instance_uid(int k) const { return digest_.uid("slice " + std::to_string(k)); }

  /// The attributes about the file itself, which stand before the slice's.
  Attributes meta_of(int k) const {
    Attributes meta;
    meta.put(0x00020001, "OB", std::string_view("\0\1", 2));
    meta.text(0x00020002, "UI", storage());
    meta.text(0x00020003, "UI", instance_uid(k));
    meta.text(0x00020010, "UI", "1.2.840.10008.1.2.1");  // explicit VR, little-endian
    meta.text(0x00020012, "UI", DicomDigest().uid("octotomy"));
    meta.text(0x00020013, "SH", "OCTOTOMY");
    const auto length = static_cast<std::uint32_t>(meta.encoded().size());
    meta.put(0x00020000, "UL", {reinterpret_cast<const char*>(&length), sizeof length});
    return meta;
  }

  void put_patient_and_study(Attributes& slice) const {
    slice.text(0x00080005, "CS", "ISO_IR 192");
    slice.text(0x00080020, "DA", "20000101");  // a date of its own would break byte equality
    slice.text(0x00080030, "TM", "000000");
    slice.text(0x00080050, "SH", "");
    slice.text(0x00080060, "CS", is_mr_ ? "MR" : "CT");
    slice.text(0x00080070, "LO", "Octotomy");
    slice.text(0x00080090, "PN", "");
    slice.text(0x0008103e, "LO", options_.series_description);
    slice.text(0x00100010, "PN", options_.patient_name);
    slice.text(0x00100020, "LO", "OCTOTOMY");
    slice.text(0x00100030, "DA", "");
    slice.text(0x00100040, "CS", "");
    slice.text(0x00185100, "CS", "HFS");
    slice.text(0x0020000d, "UI", digest_.uid("study"));
    slice.text(0x0020000e, "UI", digest_.uid("series"));
    slice.text(0x00200010, "SH", "1");
    slice.text(0x00200011, "IS", "1");
    slice.text(0x00200052, "UI", digest_.uid("frame"));
    slice.text(0x00200060, "CS", "");
    slice.text(0x00201040, "LO", "");
  }

  /// What an MR image must say: that nothing is known of how it was acquired.
  static void put_acquisition(Attributes& slice) {
    slice.text(0x00180020, "CS", "RM");
    slice.text(0x00180021, "CS", "NONE");
    for (const auto& [tag, vr] :
         {std::pair{DicomTag{0x00180022}, "CS"}, std::pair{DicomTag{0x00180023}, "CS"},
          std::pair{DicomTag{0x00180080}, "DS"}, std::pair{DicomTag{0x00180081}, "DS"},
          std::pair{DicomTag{0x00180091}, "IS"}})
      slice.text(tag, vr, "");
  }

  /// Takes the source's attributes over and refers to the images behind the slice (PS3.3, C.7.6.1, C.12.2).
  void put_source(Attributes& slice, const DicomSource& source, int k) const {
    constexpr DicomTag first_of_acquisition = 0x00180020;
    constexpr DicomTag last_of_acquisition = 0x00180fff;
    for (const auto& [tag, text] : source.attributes)
      if (is_mr_ || tag < first_of_acquisition || tag > last_of_acquisition)
        slice.text(tag, text.vr.c_str(), text.value);
    // Empty, a laterality says that it is unknown whether the body part is one of a pair (PS3.3, C.7.3.1).
    if (source.attributes.contains(0x00180015) && !source.attributes.contains(0x00200060))
      slice.remove(0x00200060);
    // Far from the scanner's own numbers, so that viewers list it apart from them.
    slice.text(0x00200011, "IS", std::to_string(source.series_number + 1000));
    Attributes purpose;
    purpose.text(0x00080100, "SH", "121322");
    purpose.text(0x00080102, "SH", "DCM");
    purpose.text(0x00080104, "LO", "Source image for image processing operation");
    std::vector<Attributes> references;
    std::vector<Attributes> images;
    for (const DicomSource::Image& image : images_behind(source, scene_.lattice, k)) {
      Attributes reference;
      reference.text(0x00081150, "UI", image.class_uid);
      reference.text(0x00081155, "UI", image.instance_uid);
      references.push_back(reference);
      reference.sequence(0x0040a170, {purpose});
      images.push_back(reference);
    }
    if (images.empty()) return;
    slice.text(0x00082111, "ST", "Resampled to a lattice where the source is not one");
    slice.sequence(0x00082112, images);
    Attributes series;
    series.text(0x0020000e, "UI", source.series_uid);
    series.sequence(0x0008114a, references);
    slice.sequence(0x00081115, {series});
  }

  void put_image(Attributes& slice, int k) const {
    slice.text(0x00080008, "CS", is_mr_ ? "DERIVED\\SECONDARY\\OTHER" : "DERIVED\\SECONDARY\\AXIAL");
    slice.text(0x00080016, "UI", storage());
    slice.text(0x00080018, "UI", instance_uid(k));
    slice.text(0x00180050, "DS", dicom_decimal(step_mm_));
    if (!is_mr_) slice.text(0x00180060, "DS", "");
    slice.text(0x00200012, "IS", "1");
    slice.text(0x00200013, "IS", std::to_string(k + 1));
    slice.text(0x00200032, "DS", dicom_decimals(scene_.lattice.lps_mm({0.0, 0.0, k})));
    slice.text(0x00200037, "DS", dicom_decimals(along_row_) + "\\" + dicom_decimals(along_column_));
    slice.text(0x00280030, "DS", dicom_decimal(spacing_mm_.y) + "\\" + dicom_decimal(spacing_mm_.x));
    if (is_mr_) return;
    slice.text(0x00281052, "DS", "0");
    slice.text(0x00281053, "DS", "1");
    slice.text(0x00281054, "LO", scene_.meaning == Meaning::Hounsfield ? "HU" : "US");
  }

  void put_pixels(Attributes& slice, const Int16Samples& samples) const {
    slice.number(0x00280002, 1);
    slice.text(0x00280004, "CS", "MONOCHROME2");
    slice.number(0x00280010, static_cast<std::uint16_t>(scene_.lattice.dims.y));
    slice.number(0x00280011, static_cast<std::uint16_t>(scene_.lattice.dims.x));
    slice.number(0x00280100, 16);
    slice.number(0x00280101, 16);
    slice.number(0x00280102, 15);
    slice.number(0x00280103, 1);
    slice.put(0x7fe00010, "OW",
              {reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof samples[0]});
  }

  const Scene& scene_;
  const DicomOptions& options_;
  glm::dvec3 spacing_mm_{1.0};
  glm::dvec3 along_row_{1, 0, 0};
  glm::dvec3 along_column_{0, 1, 0};
  double step_mm_ = 1.0;
  bool is_mr_ = false;
  DicomDigest digest_;
};

std::string slice_name(int k) {
  char name[32];
  std::snprintf(name, sizeof name, "slice_%04d.dcm", k + 1);
  return name;
}

}  // namespace

void write_dicom_series(const Scene& scene, const fs::path& folder, const DicomOptions& options) {
  const SeriesWriter series(scene, options);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::runtime_error(folder.string() + ": the folder cannot be made: " + error.message());
  for (int k = 0; k < scene.lattice.dims.z; ++k)
    if (fs::exists(folder / slice_name(k)))
      throw std::runtime_error((folder / slice_name(k)).string() +
                               ": is there already; choose another folder or empty it");
  Staging staging(folder);
  for (int k = 0; k < scene.lattice.dims.z; ++k)
    series.write(k, staging.folder() / slice_name(k), folder / slice_name(k));
  staging.commit();
}

}  // namespace octotomy::voxel
