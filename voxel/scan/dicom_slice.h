// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
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
  bool are_bytes_swapped = false;  ///< big-endian words, each of two pixels of one byte
  unsigned allocated = 16;
  unsigned stored = 16;
  unsigned high = 15;
  bool is_signed = false;
  bool states_sign = true;     ///< else PixelRepresentation is absent
  bool holds_overlay = false;  ///< bits outside of the stored ones are an overlay's (until DICOM 2004)
};

/// Stored values that are no measurements, both ends included (DICOM PS3.3, C.7.5.1.1.2).
struct DicomPadding {
  double low = 0.0;
  double high = 0.0;
};

/// A Modality LUT (DICOM PS3.3, C.11.1): stored value `first` + i means values[i]; the first and the last
/// entry hold for all stored values below and above.
struct ModalityLut {
  double first = 0.0;
  std::vector<std::uint16_t> values;
  std::string type;  ///< the unit: "HU", "US"
};

/// A Real World Value Mapping (DICOM PS3.3, C.7.6.16.2.11), which stands beside the rescale.
struct RealWorldMapping {
  std::optional<double> slope, intercept;  ///< none of a mapping by a table
  std::optional<double> first, last;       ///< stored values that it is stated for
  std::string unit;                        ///< as coded, in UCUM: "[hnsf'U]"
};

/// One file's part in an image that was stored in several files (DICOM PS3.3, C.7.6.16.1).
struct Concatenation {
  std::string uid;  ///< empty: the image is in one file
  int number = 0;   ///< of this part, from 1 on
  int total = 0;    ///< 0: the header does not state it
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
  std::string assumed_spacing;        ///< the attribute that replaces PixelSpacing, for people
  bool position_of_acr_nema = false;  ///< from the attributes of 1988, because DICOM's are absent
  bool inverted = false;              ///< MONOCHROME1
  bool is_localizer = false;          ///< by ImageType
  std::optional<double> slope;
  std::optional<double> intercept;
  std::shared_ptr<const ModalityLut> lut;  ///< applied instead of slope and intercept
  std::optional<DicomPadding> padding;
  std::string decimal_commas;  ///< attributes whose numbers have a comma for the point, for people
  std::vector<RealWorldMapping> real_world;  ///< not applied
  std::optional<double> location_mm;         ///< SliceLocation, of no stated origin
  std::string patient_orientation;           ///< PatientOrientation: "L\\P"
  std::string assumed_coding;          ///< how the file's coding was read against its header, for people
  std::string doubts;                  ///< what the header says against a measurement, for people
  std::string assumed_modality;        ///< what the header states where the images' class contradicts it
  std::string assumed_place;           ///< how a frame without a position of its own was placed, for people
  std::string excess_pixels;           ///< pixel data beyond what the header counts, for people
  std::optional<double> aspect_ratio;  ///< of PixelAspectRatio: height by width
  std::optional<int> stated_images;    ///< ImagesInAcquisition, or NumberOfSlices
  Concatenation concatenation;
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
  bool is_directory = false;    ///< a DICOMDIR, which lists the images beside it
  std::string series_uid = {};  ///< of the file, if it states one
};

/// Reads the header of a file and checks that its attributes and pixels end within it. Returns one slice, or
/// one for each frame of an enhanced CT or MR. Never throws on a file's contents. Memory: the file's
/// attributes, or the whole file if it is compressed. Numbers with a decimal comma are read. Unusable are
/// positions beyond 1e9 mm, spacings not from 1e-6 to 1e6 mm, directions longer than a unit, rescaled values
/// beyond single precision, numbers that cannot be read, and transfer syntaxes that nothing here decodes.
std::variant<std::vector<DicomSlice>, NoSlice> read_dicom_slices(const std::filesystem::path& path);

/// How many bytes a frame's pixels take before compression.
std::size_t frame_bytes(const DicomSlice& slice);

/// The first `count` bytes of a file, or all of them. Throws Error, Input, if they cannot be read.
std::string beginning_of(const std::filesystem::path& path, std::size_t count);

/// A deflated file whose bytes from `at` on are inflated. Throws Error, Input.
std::string inflated(const std::string& bytes, std::size_t at);

}  // namespace octotomy::voxel
