// SPDX-License-Identifier: AGPL-3.0-or-later
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include "voxel/dicom_file.h"
#include "voxel/staging.h"
#include "voxel/write_scene.h"

namespace octotomy::voxel {

namespace {

namespace fs = std::filesystem;

static_assert(std::endian::native == std::endian::little, "values are written as they stand in memory");

/// A decimal string: the most digits that its 16 characters hold.
std::string decimal(double number) {
  char text[40];
  for (int digits = 17; digits > 0; --digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, number);
    if (std::strlen(text) <= 16) break;
  }
  return text;
}

std::string decimals(const glm::dvec3& p) {
  return decimal(p.x) + "\\" + decimal(p.y) + "\\" + decimal(p.z);
}

/// 128 bits that follow from what is put in: two FNV-1a sums with different beginnings. Not for secrets.
class Digest {
 public:
  void add(const void* bytes, std::size_t count) {
    const auto* byte = static_cast<const unsigned char*>(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      high_ = (high_ ^ byte[i]) * prime;
      low_ = (low_ ^ byte[i]) * prime;
      low_ ^= low_ >> 29;  // sets the second sum apart from the first
    }
  }
  void add(const std::string& text) { add(text.data(), text.size() + 1); }

  /// An identifier of the form 2.25.<UUID as an integer>, a UUID of version 8 (RFC 9562).
  std::string uid() const {
    __extension__ using Wide = unsigned __int128;
    const std::uint64_t high = (high_ & ~std::uint64_t{0xf000}) | 0x8000;
    const std::uint64_t low = (low_ & ~(std::uint64_t{3} << 62)) | (std::uint64_t{2} << 62);
    std::string digits;
    for (Wide rest = (Wide{high} << 64) | low; rest != 0; rest /= 10)
      digits.insert(digits.begin(), static_cast<char>('0' + static_cast<int>(rest % 10)));
    return "2.25." + digits;
  }
  std::string uid(const std::string& of) const {
    Digest with = *this;
    with.add(of);
    return with.uid();
  }

 private:
  static constexpr std::uint64_t prime = 0x100000001b3;
  std::uint64_t high_ = 0xcbf29ce484222325;
  std::uint64_t low_ = 0x84222325cbf29ce4;
};

constexpr const char* ct_image_storage = "1.2.840.10008.5.1.4.1.1.2";

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

  std::string encoded() const {
    std::string bytes;
    const auto append = [&](std::uint32_t number, std::size_t width) {
      bytes.append(reinterpret_cast<const char*>(&number), width);
    };
    for (const auto& [tag, value] : values_) {
      append(tag >> 16, 2);
      append(tag & 0xffffu, 2);
      bytes += value.vr;
      const bool is_wide = value.vr == "OB" || value.vr == "OW";
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
  }

  /// Writes slice k to `path`; `name` is what errors call it.
  void write(int k, const fs::path& path, const fs::path& name) const {
    const Int16Samples samples = samples_of(k);
    Attributes slice;
    put_patient_and_study(slice);
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

  std::string instance_uid(int k) const { return digest_.uid("slice " + std::to_string(k)); }

  /// The attributes about the file itself, which stand before the slice's.
  Attributes meta_of(int k) const {
    Attributes meta;
    meta.put(0x00020001, "OB", std::string_view("\0\1", 2));
    meta.text(0x00020002, "UI", ct_image_storage);
    meta.text(0x00020003, "UI", instance_uid(k));
    meta.text(0x00020010, "UI", "1.2.840.10008.1.2.1");  // explicit VR, little-endian
    meta.text(0x00020012, "UI", Digest().uid("octotomy"));
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
    slice.text(0x00080060, "CS", "CT");
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

  void put_image(Attributes& slice, int k) const {
    slice.text(0x00080008, "CS", "DERIVED\\SECONDARY\\AXIAL");
    slice.text(0x00080016, "UI", ct_image_storage);
    slice.text(0x00080018, "UI", instance_uid(k));
    slice.text(0x00180050, "DS", decimal(step_mm_));
    slice.text(0x00180060, "DS", "");
    slice.text(0x00200012, "IS", "1");
    slice.text(0x00200013, "IS", std::to_string(k + 1));
    slice.text(0x00200032, "DS", decimals(scene_.lattice.lps_mm({0.0, 0.0, k})));
    slice.text(0x00200037, "DS", decimals(along_row_) + "\\" + decimals(along_column_));
    slice.text(0x00280030, "DS", decimal(spacing_mm_.y) + "\\" + decimal(spacing_mm_.x));
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
  Digest digest_;
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
