// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <vector>

#include "voxel/dicom/character_set.h"
#include "voxel/scan/dicom_derived.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

constexpr const char* ct_image_storage = "1.2.840.10008.5.1.4.1.1.2";
constexpr const char* mr_image_storage = "1.2.840.10008.5.1.4.1.1.4";
constexpr const char* secondary_capture_storage = "1.2.840.10008.5.1.4.1.1.7";

/// The rescale of the written files: sample = slope * stored + intercept.
struct Rescale {
  double slope = 1.0;
  double intercept = 0.0;
};

/// A number after rounding to a decimal string of 16 characters.
double as_written(double number) {
  return std::strtod(dicom_decimal(number).c_str(), nullptr);
}

/// The stored value of Scene::padding. No measured sample is stored as this number, because padding is below
/// all measured samples.
constexpr std::int16_t stored_padding = std::numeric_limits<std::int16_t>::min();

/// Slope 1 and intercept 0 for integers in int16's range, else the finest power of two for which the range of
/// samples fits 16 bits. Samples that are multiples of the slope, such as halves, keep their values; others
/// change by at most half the slope.
Rescale rescale_of(const Scene& scene) {
  const auto is_exact = [&](double value) {
    return value >= stored_padding + (scene.padding ? 1 : 0) &&
           value <= std::numeric_limits<std::int16_t>::max() && value == std::trunc(value);
  };
  if (std::holds_alternative<Int16Samples>(scene.samples)) return {};
  const auto& samples = std::get<FloatSamples>(scene.samples);
  const auto is_padding = [&](float value) { return static_cast<double>(value) == scene.padding; };
  if (std::all_of(samples.begin(), samples.end(),
                  [&](float value) { return is_padding(value) || is_exact(value); }))
    return {};
  if (!std::all_of(samples.begin(), samples.end(), [](float value) { return std::isfinite(value); }))
    throw InvalidInput("a sample is not finite: DICOM stores numbers only");
  const Range values = range(scene);
  // One stored value is reserved at either end, because the intercept is rounded.
  double slope = std::exp2(std::ceil(std::log2(std::max(values.high - values.low, 1e-6) / 65533.0)));
  slope = as_written(slope);
  return {slope, as_written(std::round(0.5 * (values.low + values.high) / slope) * slope)};
}

/// Whether every point of a lattice is a point of another one, to a thousandth of its spacing.
bool lies_on(const Lattice& lattice, const Lattice& other) {
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 last = glm::dvec3(lattice.dims - 1);
    const glm::dvec3 p = other.voxel(
        lattice.lps_mm({corner & 1 ? last.x : 0, corner & 2 ? last.y : 0, corner & 4 ? last.z : 0}));
    if (glm::any(glm::greaterThan(glm::abs(p - glm::round(p)), glm::dvec3(1e-3)))) return false;
  }
  const glm::dvec3 spacing_mm = lattice.spacing_mm(), other_mm = other.spacing_mm();
  return glm::all(glm::lessThan(glm::abs(spacing_mm - other_mm), 1e-3 * other_mm));
}

/// Writes the slices of one series.
class SeriesWriter {
 public:
  SeriesWriter(const Scene& scene, const DicomOptions& options) : scene_(scene), options_(options) {
    check(scene);
    check_dicom_text(options.patient_name, "patient_name");
    check_dicom_text(options.series_description, "series_description");
    const glm::dmat4& lps_from_voxel = scene.lattice.lps_from_voxel;
    spacing_mm_ = scene.lattice.spacing_mm();
    along_row_ = glm::dvec3(lps_from_voxel[0]) / spacing_mm_.x;
    along_column_ = glm::dvec3(lps_from_voxel[1]) / spacing_mm_.y;
    // The tolerance allows axes rounded to single precision. ImageOrientationPatient itself is written with
    // at least 13 decimals.
    if (std::abs(glm::dot(along_row_, along_column_)) > 1e-6)
      throw InvalidInput("a DICOM slice's rows and columns must be perpendicular: resample the scene");
    if (scene.lattice.dims.x > 65535 || scene.lattice.dims.y > 65535)
      throw InvalidInput("a DICOM slice has at most 65535 rows and columns");
    step_mm_ = std::abs(glm::dot(glm::dvec3(lps_from_voxel[2]), glm::cross(along_row_, along_column_)));
    digest_.add(&lps_from_voxel, sizeof lps_from_voxel);
    digest_.add(&scene.lattice.dims, sizeof scene.lattice.dims);
    std::visit([&](const auto& samples) { digest_.add(samples.data(), samples.size() * sizeof samples[0]); },
               scene.samples);
    digest_.add(options.patient_name);
    digest_.add(options.series_description);
    if (options.source) digest_.add(options.source->series_uid);
    is_secondary_ = is_written_as_secondary_capture(scene);
    is_mr_ = scene.modality == "MR";
    // Identifiers are computed from everything that the files contain.
    if (!scene.declared_unit.empty()) digest_.add(scene.declared_unit);
    if (is_secondary_) digest_.add(scene.modality);
    rescale_ = rescale_of(scene);
    values_ = range(scene);
    is_resampled_ =
        options.source && !(options.source->lattice && lies_on(scene.lattice, *options.source->lattice));
  }

  /// Writes slice k to `path`; error messages refer to the file as `name`.
  void write(int k, const fs::path& path, const fs::path& name) const {
    const Int16Samples samples = samples_of(k);
    DicomAttributes slice;
    put_study(slice, options_, digest_, !is_ascii(options_.series_description));
    put_acquisition(slice);
    if (options_.source) put_source(slice, *options_.source, k);
    put_image(slice, k);
    put_pixels(slice, samples);
    write_dicom_file(path, name, slice);
  }

 private:
  Int16Samples samples_of(int k) const {
    const std::size_t area =
        static_cast<std::size_t>(scene_.lattice.dims.x) * static_cast<std::size_t>(scene_.lattice.dims.y);
    Int16Samples slice(area);
    std::visit(
        [&](const auto& samples) {
          for (std::size_t i = 0; i < area; ++i) {
            const auto value = static_cast<double>(samples[static_cast<std::size_t>(k) * area + i]);
            slice[i] =
                value == scene_.padding
                    ? stored_padding
                    : static_cast<std::int16_t>(std::lround((value - rescale_.intercept) / rescale_.slope));
          }
        },
        scene_.samples);
    return slice;
  }

  const char* storage() const {
    return is_secondary_ ? secondary_capture_storage : is_mr_ ? mr_image_storage : ct_image_storage;
  }
  /// Writes the unit only if the file declared it, not if this program derived it from the samples' values.
  std::string rescale_type() const {
    if (!scene_.declared_unit.empty()) return scene_.declared_unit;
    return scene_.meaning == Meaning::Hounsfield ? "HU" : "US";
  }
  std::string instance_uid(int k) const { return digest_.uid("slice " + std::to_string(k)); }

  /// Every MR image must describe its acquisition (PS3.3, C.8.3.1); these values mean that it is unknown.
  void put_acquisition(DicomAttributes& slice) const {
    slice.put(0x00080060, "CS", is_secondary_ ? scene_.modality : is_mr_ ? "MR" : "CT");
    if (is_secondary_) slice.put(0x00080064, "CS", "WSD");  // from a workstation (PS3.3, C.8.6.1)
    slice.put(0x00185100, "CS", "HFS");
    slice.put(0x00200060, "CS", "");
    if (!is_mr_) return;
    slice.put(0x00180020, "CS", "RM");
    slice.put(0x00180021, "CS", "NONE");
    for (const auto& [tag, vr] :
         {std::pair{DicomTag{0x00180022}, "CS"}, std::pair{DicomTag{0x00180023}, "CS"},
          std::pair{DicomTag{0x00180080}, "DS"}, std::pair{DicomTag{0x00180081}, "DS"},
          std::pair{DicomTag{0x00180091}, "IS"}})
      slice.put(tag, vr, "");
  }

  /// Copies the source's acquisition attributes and writes references to the images from which the slice was
  /// made.
  void put_source(DicomAttributes& slice, const DicomSource& source, int k) const {
    const auto is_scanners = [](DicomTag tag) { return tag >= 0x00180020 && tag <= 0x00180fff; };
    for (const auto& [tag, text] : source.attributes)
      if (tag == 0x00200060 || (tag >> 16 == 0x0018 && (is_mr_ || !is_scanners(tag))))
        slice.put(tag, text.vr.c_str(), text.value);
    // If a body part is stated, an empty laterality would mean that the side is unknown (PS3.3, C.7.3.1).
    if (source.attributes.contains(0x00180015) && !source.attributes.contains(0x00200060))
      slice.remove(0x00200060);
    // Adds 1000 to the source's series number, so that it differs from the scanner's numbers and viewers list
    // the series separately.
    slice.put(0x00200011, "IS", std::to_string(source.series_number + 1000));
    const std::vector<DicomSource::Image> images = images_behind(source, scene_.lattice, k);
    if (images.empty()) return;
    slice.put(0x00082111, "ST",
              is_resampled_ ? "Resampled: the source's images form another lattice or none"
                            : "On the source's own pixels, not resampled");
    put_source_images(slice, images);
    put_referenced_series(slice, source.series_uid, images);
  }

  void put_image(DicomAttributes& slice, int k) const {
    slice.put(0x00080008, "CS",
              is_mr_ || is_secondary_ ? "DERIVED\\SECONDARY\\OTHER" : "DERIVED\\SECONDARY\\AXIAL");
    slice.put(0x00080016, "UI", storage());
    slice.put(0x00080018, "UI", instance_uid(k));
    slice.put(0x00180050, "DS", dicom_decimal(step_mm_));
    if (!is_mr_ && !is_secondary_) slice.put(0x00180060, "DS", "");
    slice.put(0x00200012, "IS", "1");
    slice.put(0x00200013, "IS", std::to_string(k + 1));
    slice.put(0x00200032, "DS", dicom_decimals(scene_.lattice.lps_mm({0.0, 0.0, k})));
    slice.put(0x00200037, "DS", dicom_decimals(along_row_) + "\\" + dicom_decimals(along_column_));
    put_window(slice);
    slice.put(0x00280030, "DS", dicom_decimal(spacing_mm_.y) + "\\" + dicom_decimal(spacing_mm_.x));
    if (is_mr_ && rescale_.slope == 1.0 && scene_.declared_unit.empty()) return;
    slice.put(0x00281052, "DS", dicom_decimal(rescale_.intercept));
    slice.put(0x00281053, "DS", dicom_decimal(rescale_.slope));
    slice.put(0x00281054, "LO", rescale_type());
  }

  /// The window in which viewers show the slices first: bone and soft tissue in Hounsfield units, else all
  /// values.
  void put_window(DicomAttributes& slice) const {
    const bool is_hounsfield = scene_.meaning == Meaning::Hounsfield;
    const double centre = is_hounsfield ? 500.0 : 0.5 * (values_.low + values_.high);
    const double width = is_hounsfield ? 2000.0 : std::max(values_.high - values_.low, 1.0);
    slice.put(0x00281050, "DS", dicom_decimal(centre));
    slice.put(0x00281051, "DS", dicom_decimal(width));
  }

  void put_pixels(DicomAttributes& slice, const Int16Samples& samples) const {
    slice.put_short(0x00280002, 1);
    slice.put(0x00280004, "CS", "MONOCHROME2");
    slice.put_short(0x00280010, static_cast<std::uint16_t>(scene_.lattice.dims.y));
    slice.put_short(0x00280011, static_cast<std::uint16_t>(scene_.lattice.dims.x));
    slice.put_short(0x00280100, 16);
    slice.put_short(0x00280101, 16);
    slice.put_short(0x00280102, 15);
    slice.put_short(0x00280103, 1);
    if (scene_.padding) slice.put(0x00280120, "SS", std::string("\x00\x80", 2));
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
  bool is_secondary_ = false;
  bool is_resampled_ = false;
  Rescale rescale_;
  Range values_;
  DicomDigest digest_;
};

std::string slice_name(int k) {
  char name[32];
  std::snprintf(name, sizeof name, "slice_%04d.dcm", k + 1);
  return name;
}

/// Whether write_dicom_series() may have written a file of this name.
bool is_slice_name(const std::string& name) {
  return name.starts_with("slice_") && name.ends_with(".dcm");
}

/// A folder of slices that is renamed into place when all slices are written. If the target folder already
/// exists, slices are staged inside it instead, because the folder may be a mount point or another program's
/// working directory.
class StagedSeries {
 public:
  explicit StagedSeries(const fs::path& folder)
      : folder_(folder), place_(place_of(folder)), is_new_(!fs::exists(place_)), staging_(made_beside()) {
    if (!is_new_) return;
    std::error_code error;
    fs::create_directory(path(), error);
    need_made(error);
  }

  fs::path path() const { return is_new_ ? staging_.folder() / place_.filename() : staging_.folder(); }
  void commit() { staging_.commit(); }

 private:
  /// The folder to stage in.
  fs::path made_beside() const {
    if (!is_new_) return place_;
    std::error_code error;
    fs::create_directories(place_.parent_path(), error);
    need_made(error);
    return place_.parent_path();
  }
  void need_made(const std::error_code& error) const {
    if (error) refuse(folder_, "the folder cannot be made: " + error.message(), code_of_errno(error.value()));
  }

  fs::path folder_, place_;
  bool is_new_ = false;
  StagedFiles staging_;
};

}  // namespace

void need_no_slices(const fs::path& folder) {
  std::vector<fs::path> slices;
  std::error_code is_none;
  for (fs::directory_iterator entry(folder, is_none); !is_none && entry != fs::directory_iterator();
       entry.increment(is_none))
    if (is_slice_name(entry->path().filename().string())) slices.push_back(entry->path().filename());
  if (!slices.empty())
    refuse(folder / *std::min_element(slices.begin(), slices.end()),
           "exists already; choose another folder or empty it");
}

bool is_written_as_secondary_capture(const Scene& scene) {
  return !scene.modality.empty() && scene.modality != "CT" && scene.modality != "MR";
}

double dicom_rounding(const Scene& scene) {
  const auto* samples = std::get_if<FloatSamples>(&scene.samples);
  if (samples == nullptr) return 0.0;
  const Rescale rescale = rescale_of(scene);
  double most = 0.0;
  for (const float sample : *samples) {
    const auto value = static_cast<double>(sample);
    if (value == scene.padding) continue;
    const double stored = std::round((value - rescale.intercept) / rescale.slope);
    most = std::max(most, std::abs(rescale.slope * stored + rescale.intercept - value));
  }
  return most;
}

void write_dicom_series(const Scene& scene, const fs::path& folder, const DicomOptions& options) {
  need_disk(folder, least_file_bytes(scene.lattice, sizeof(std::int16_t), folder));
  const SeriesWriter series(scene, options);
  need_no_slices(folder);
  StagedSeries staged(folder);
  for (int k = 0; k < scene.lattice.dims.z; ++k)
    series.write(k, staged.path() / slice_name(k), folder / slice_name(k));
  staged.commit();
}

}  // namespace octotomy::voxel
