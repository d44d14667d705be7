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

#include "voxel/dicom/dicom_file.h"
#include "voxel/dicom/dicom_traits.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The position of an image's pixels in its file, and their format: each pixel takes `allocated` bits, and
/// the `stored` bits up to bit `high` are its value. With 12 allocated bits, two pixels share three bytes.
struct DicomPixels {
  std::string transfer_syntax;
  std::vector<DicomExtent> parts;  ///< one part for raw pixels; the fragments of compressed ones
  bool is_compressed = false;
  bool is_deflated = false;  ///< the file is deflated; `parts` then are offsets in the inflated file
  bool is_big_endian = false;
  bool are_bytes_swapped = false;  ///< one-byte pixels are stored in pairs as big-endian words
  unsigned allocated = 16;
  unsigned stored = 16;
  unsigned high = 15;
  bool is_signed = false;
  bool states_sign = true;     ///< else PixelRepresentation is absent
  bool holds_overlay = false;  ///< bits outside the stored bits contain an overlay (until DICOM 2004)
};

/// The range of stored values that are not measurements, both ends included (DICOM PS3.3, C.7.5.1.1.2).
struct DicomPadding {
  double low = 0.0;
  double high = 0.0;
};

/// A Modality LUT (DICOM PS3.3, C.11.1): stored value `first` + i is mapped to values[i]. The first entry
/// also applies to all lower stored values, the last entry to all higher ones.
struct ModalityLut {
  double first = 0.0;
  std::vector<std::uint16_t> values;
  std::string type;  ///< the unit: "HU", "US"
};

/// A Real World Value Mapping (DICOM PS3.3, C.7.6.16.2.11), which exists in addition to the rescale.
struct RealWorldMapping {
  std::optional<double> slope, intercept;  ///< none if the mapping is a table
  std::optional<double> first, last;       ///< least and largest stored value to which the mapping applies
  std::string unit;                        ///< as coded, in UCUM: "[hnsf'U]"
};

/// The part of a multi-frame image in one of several files (DICOM PS3.3, C.7.6.16.1).
struct Concatenation {
  std::string uid;  ///< identifier that all parts share; empty: the image is in one file
  int number = 0;   ///< number of this part, counted from 1
  int total = 0;    ///< number of parts; 0: not stated
};

/// The part of a grey DICOM image's header that a volume needs. The image is a file's only frame, or one of
/// its frames. LPS, millimetres.
struct DicomSlice {
  std::filesystem::path path;
  /// To show to users: the path below the scan's folder, with the frame's number if the file has several.
  std::string name;
  int frame = 0;
  DicomPixels pixels;
  std::string class_uid;  ///< SOP class, (0008,0016)
  std::string instance_uid;
  std::string series_uid;
  std::string series_description;  ///< UTF-8
  std::string modality;
  Identity identity;
  std::string rescale_type;
  int series_number = 0;
  int instance_number = 0;
  glm::ivec2 size_px{0};             ///< number of columns and of rows
  glm::dvec2 spacing_mm{0.0};        ///< distance between columns, and between rows
  glm::dvec3 along_row{1, 0, 0};     ///< direction from column to column, as in the file
  glm::dvec3 along_column{0, 1, 0};  ///< direction from row to row, as in the file
  glm::dvec3 first_mm{0.0};          ///< centre of the first pixel, LPS
  std::string assumed_spacing;       ///< the attribute used instead of PixelSpacing, to show to users
  /// The position is that of the ACR-NEMA attributes of 1988, because DICOM's are absent.
  bool position_of_acr_nema = false;
  bool inverted = false;      ///< MONOCHROME1
  bool is_localizer = false;  ///< whether ImageType states a scout view
  std::optional<double> slope;
  std::optional<double> intercept;
  std::shared_ptr<const ModalityLut> lut;  ///< applied instead of slope and intercept
  std::optional<DicomPadding> padding;
  std::string decimal_commas;  ///< names of attributes whose numbers have a decimal comma, to show to users
  std::vector<RealWorldMapping> real_world;  ///< not applied
  std::optional<double> location_mm;         ///< SliceLocation, whose origin is not stated
  std::string patient_orientation;           ///< PatientOrientation: "L\\P"
  /// How the file's coding differs from the header's statement, to show to users.
  std::string assumed_coding;
  /// Statements in the header that cast doubt on the image as a measurement, to show to users.
  std::string doubts;
  std::string assumed_modality;  ///< the modality in the header if the image's class contradicts it
  /// How the position of a frame was computed if the frame states none, to show to users.
  std::string assumed_place;
  /// Description of pixel data beyond the images that the header states, to show to users.
  std::string excess_pixels;
  std::optional<double> aspect_ratio;  ///< PixelAspectRatio: height divided by width
  std::optional<int> stated_images;    ///< ImagesInAcquisition, or NumberOfSlices
  Concatenation concatenation;
  std::optional<double> thickness_mm;
  std::optional<double> spacing_tag_mm;  ///< SpacingBetweenSlices
  std::optional<double> tilt_deg;        ///< GantryDetectorTilt; its sign varies between vendors
  std::string lossy;                     ///< the lossy compression of the pixels; empty: lossless
  DicomTraitValues traits;
};

/// A file without a slice, and the reason why it has none.
struct NoSlice {
  /// Stray: the file contains no image, so no part of a scan is lost. Unusable: an image that cannot be part
  /// of a volume. Damaged: an image whose file is truncated or corrupt.
  enum class Kind { Stray, Unusable, Damaged };

  std::string reason;
  Kind kind = Kind::Stray;
  bool is_directory = false;    ///< a DICOMDIR, which lists the images beside it
  std::string series_uid = {};  ///< series of the file; empty if the file states none
};

/// Reads the header of a file and checks that its attributes and pixels end within it. Returns one slice for
/// each frame of the file. Never throws on a file's contents. Memory: the file's attributes, or the whole
/// file if it is deflated. Numbers with a decimal comma are read. An image is unusable if it has a position
/// beyond 1e9 mm, a spacing outside 1e-6 to 1e6 mm, directions that are not two unit vectors, rescaled values
/// beyond single precision, a number that cannot be read, or a transfer syntax that this program cannot
/// decode.
std::variant<std::vector<DicomSlice>, NoSlice> read_dicom_slices(const std::filesystem::path& path);

/// The number of bytes in a frame's uncompressed pixels.
std::size_t frame_bytes(const DicomSlice& slice);

/// The first `count` bytes of a file, or all of them. Throws Error (Input) if they cannot be read.
std::string beginning_of(const std::filesystem::path& path, std::size_t count);

/// The file's bytes before `at`, followed by the inflated bytes from `at` on. Throws Error (Input) if these
/// are damaged.
std::string inflated(const std::string& bytes, std::size_t at);

}  // namespace octotomy::voxel
