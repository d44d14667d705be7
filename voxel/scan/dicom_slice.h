// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "voxel/scan/dicom_file.h"
#include "voxel/scan/dicom_traits.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The place of an image's pixels in its file, and their format: each pixel takes `allocated` bits, of which
/// the `stored` bits up to bit `high` are its value. Of 12 allocated bits, two pixels share three bytes.
struct DicomPixels {
  std::string transfer_syntax;
  std::vector<DicomExtent> parts;  ///< one of raw pixels; fragments of compressed ones
  bool is_compressed = false;
  bool is_deflated = false;  ///< parts are then offsets in the inflated file
  bool is_big_endian = false;
  unsigned allocated = 16;
  unsigned stored = 16;
  unsigned high = 15;
  bool is_signed = false;
};

/// The part of a grey DICOM image's header that a volume needs. The image is a file of one frame or one frame
/// of several. LPS, millimetres.
struct DicomSlice {
  std::filesystem::path path;
  std::string
      name;  ///< for people: the path below the scan's folder, with the frame's number if it has several
  int frame = 0;
  DicomPixels pixels;
  std::string class_uid;  ///< of the storage, (0008,0016)
  std::string instance_uid;
  std::string series_uid;
  std::string series_description;  ///< UTF-8
  std::string modality;
  Identity identity;
  std::string rescale_type;
  int series_number = 0;
  int instance_number = 0;
  glm::ivec2 size_px{0};              ///< columns, rows
  glm::dvec2 spacing_mm{0.0};         ///< between columns, between rows
  glm::dvec3 along_row{1, 0, 0};      ///< from column to column, as in the file
  glm::dvec3 along_column{0, 1, 0};   ///< from row to row
  glm::dvec3 first_mm{0.0};           ///< centre of the first pixel
  bool spacing_at_detector = false;   ///< from ImagerPixelSpacing, because PixelSpacing is absent
  bool position_of_acr_nema = false;  ///< from the attributes of 1988, because DICOM's are absent
  bool inverted = false;              ///< MONOCHROME1
  bool is_localizer = false;          ///< by ImageType
  std::optional<double> slope;
  std::optional<double> intercept;
  std::optional<double> padding;  ///< rescaled value of pixels that were not measured
  std::optional<double> thickness_mm;
  std::optional<double> spacing_tag_mm;  ///< SpacingBetweenSlices
  std::optional<double> tilt_deg;        ///< the scanner's own tag; its sign varies from vendor to vendor
  std::string lossy;                     ///< how its pixels lost values by compression; empty: they did not
  DicomTraitValues traits;
};

/// The reason why a file holds no slice.
struct NoSlice {
  /// Stray: no image, so nothing of a scan is lost. Unusable: an image that has no place in a volume.
  /// Damaged: an image whose file is cut short or spoiled.
  enum class Kind { Stray, Unusable, Damaged };

  std::string reason;
  Kind kind = Kind::Stray;
  bool is_directory = false;  ///< a DICOMDIR, which lists the images beside it
};

/// Reads the header of a file and checks that its attributes and pixels end within it. Returns one slice, or
/// one for each frame of an enhanced CT or MR. Never throws on a file's contents. Memory: the file's
/// attributes, or the whole file if it is compressed. Unusable are also positions beyond 1e9 mm, spacings not
/// from 1e-6 to 1e6 mm, directions longer than a unit, and rescaled values beyond single precision.
std::variant<std::vector<DicomSlice>, NoSlice> read_dicom_slices(const std::filesystem::path& path);

/// Whether two images store the same pixels in the same way. Throws Error, Input, if a file has changed.
bool same_pixels(const DicomSlice& a, const DicomSlice& b);

/// Decodes a slice and applies its rescale (absent, or a slope of 0: slope 1; absent: intercept 0), row by
/// row, x fastest. Returns false if a value is no integer in int16's range. Precondition: `samples` has a
/// place for every pixel. Throws Error, Input, with path and reason if the pixels cannot be decoded.
bool read_dicom_samples(const DicomSlice& slice, std::span<std::int16_t> samples);
/// Decodes to single precision; always true.
bool read_dicom_samples(const DicomSlice& slice, std::span<float> samples);

}  // namespace octotomy::voxel
