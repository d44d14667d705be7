// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/space/scene.h"
#include "voxel/volume/stated_geometry.h"
#include "voxel/volume/stored_samples.h"

namespace octotomy::voxel {

/// Formats of volume files.
enum class VolumeFormat { Nifti, Nrrd, Meta };

/// The format in which write_scene() writes a file, by its extension in upper or lower case; none for other
/// extensions.
std::optional<VolumeFormat> volume_format(const std::filesystem::path& path);
/// Like volume_format(), but for files to read: also accepts a pair of NIfTI files if the path is the .hdr or
/// .img and both files exist. A single .img file is not accepted, because DICOM files have this extension
/// too.
std::optional<VolumeFormat> readable_volume_format(const std::filesystem::path& path);

/// The two files of a NIfTI volume whose header and samples are separate.
struct NiftiPair {
  std::filesystem::path header, image;
};
/// The pair to which a .hdr or .img file, compressed or not, belongs; none for other names, or if one of the
/// two is missing.
std::optional<NiftiPair> nifti_pair(const std::filesystem::path& path);

/// The format's name in messages.
const char* name_of(VolumeFormat format);

/// The files, offsets and encoding of a volume's samples.
struct SampleFiles {
  enum class Encoding { Raw, Deflated, Text, Hex };

  StoredSamples stored;
  Encoding encoding = Encoding::Raw;
  /// The files in the order of the samples; each contains an equal part.
  std::vector<std::filesystem::path> files;
  std::uintmax_t file_at = 0;    ///< offset of the samples, or of their encoded stream, in each file
  std::uintmax_t line_skip = 0;  ///< number of lines to skip from there on
  std::uintmax_t byte_skip = 0;  ///< number of bytes to skip after these lines, counted after decoding
  bool at_end = false;           ///< if set, the samples are the last bytes of each file instead
};

/// The statements of a volume file's header.
struct VolumeHeader {
  std::map<std::string, std::string> fields;  ///< fields of a NRRD or MetaImage, by name in lower case
  StatedGeometry geometry;
  SampleFiles samples;
  /// For a segmentation of 3D Slicer whose segments overlap: the number of label maps, whose samples are
  /// interleaved.
  int layers = 1;
  std::string meaning;                 ///< "HU", "raw" or "label"; empty if the file states none
  std::string modality;                ///< DICOM's two letters; empty if the file states none
  std::optional<double> padding = {};  ///< Scene::padding, in files of this program
  std::vector<Finding> audit;          ///< lines on the header's other statements

  std::optional<std::string> field(const std::string& name) const;
};

// Names under which this program's files store values that have no field in the formats.
inline constexpr const char* meaning_key = "octotomy_meaning";
inline constexpr const char* modality_key = "octotomy_modality";
inline constexpr const char* padding_key = "octotomy_padding";
/// NIfTI has one free text, the description. In this program's files it consists of this mark, the meaning,
/// the modality and, after nifti_padding_mark, the padding.
inline constexpr std::string_view nifti_mark = "octotomy ";
inline constexpr std::string_view nifti_padding_mark = "padding=";
/// NIfTI-1 stores positions in single precision. This program's files also contain them in double precision,
/// in an extension of plain text (code 6, which other readers skip): this mark, then the first three rows of
/// lps_from_voxel.
inline constexpr std::string_view nifti_geometry_mark = "octotomy lps_from_voxel ";
inline constexpr std::int32_t nifti_text_extension = 6;

/// Reads a header. Throws Error (Input) with path and reason, if it is damaged, does not describe a scan
/// (more than one value per sample, several volumes), or states more samples than its files can hold. Memory:
/// a few megabytes.
VolumeHeader read_volume_header(const std::filesystem::path& path, VolumeFormat format);

/// Parses the text of Scene::padding into the header. If it is not a number, adds a WARN instead. Does
/// nothing if there is no text.
void take_padding(const std::optional<std::string>& text, VolumeHeader& header);

/// The audit's line about slope and intercept. `says` contains the format's names of both.
Finding rescale_finding(const StoredSamples& stored, const std::string& says);
/// Adds a third axis to a header that has two axes: perpendicular to both, with a spacing of 1 mm. The audit
/// warns of the assumption.
void add_third_axis(VolumeHeader& header);

/// Adds a line to the audit if a spacing of the field `name` has a minus sign, which the formats do not
/// define.
void warn_of_minus_signs(const char* name, const std::vector<double>& spacings, VolumeHeader& header);

/// read_volume_header() for one format.
VolumeHeader read_nifti_header(const std::filesystem::path& path);
VolumeHeader read_nrrd_header(const std::filesystem::path& path);
VolumeHeader read_meta_header(const std::filesystem::path& path);

/// The numbers of samples along the first three axes; 1 for absent axes. Throws Error (Input) if a number is
/// not an integer from 1 to 2^31 - 1, or if a further axis has more than one sample.
glm::ivec3 dims_of(const std::filesystem::path& path, const std::vector<double>& lengths);

}  // namespace octotomy::voxel
