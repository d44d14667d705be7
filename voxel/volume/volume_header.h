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

/// The format of a file that write_scene() writes, by its extension in upper or lower case; none for another.
std::optional<VolumeFormat> volume_format(const std::filesystem::path& path);
/// As volume_format(), of files that are read: also NIfTI's pairs, of which .hdr or .img is named and both
/// are there. DICOM, too, stands in .img files.
std::optional<VolumeFormat> readable_volume_format(const std::filesystem::path& path);

/// NIfTI's header and samples in two files.
struct NiftiPair {
  std::filesystem::path header, image;
};
/// The pair to which a .hdr or .img file, packed or not, belongs; none for other names and where one is
/// missing.
std::optional<NiftiPair> nifti_pair(const std::filesystem::path& path);

/// The format's name in messages.
const char* name_of(VolumeFormat format);

/// Where a volume's samples stand, and how.
struct SampleFiles {
  enum class Encoding { Raw, Deflated, Text, Hex };

  StoredSamples stored;
  Encoding encoding = Encoding::Raw;
  std::vector<std::filesystem::path> files;  ///< each holds an equal part, in this order
  std::uintmax_t file_at = 0;    ///< offset of the samples, or of their encoded stream, in each file
  std::uintmax_t line_skip = 0;  ///< lines from there that are none of them
  std::uintmax_t byte_skip = 0;  ///< bytes that follow and are none of them, counted once they are decoded
  bool at_end = false;           ///< the samples are the last bytes of each file instead
};

/// What the header of a volume file says.
struct VolumeHeader {
  std::map<std::string, std::string> fields;  ///< of a NRRD or MetaImage, by name in lower case
  StatedGeometry geometry;
  SampleFiles samples;
  /// Of a segmentation of 3D Slicer whose segments overlap: samples of so many label maps stand at each
  /// place, one behind the other.
  int layers = 1;
  std::string meaning;                 ///< "HU", "raw" or "label"; empty if the file states none
  std::string modality;                ///< DICOM's two letters; empty if the file states none
  std::optional<double> padding = {};  ///< Scene::padding, of our own files
  std::vector<Finding> audit;          ///< lines on its other statements

  std::optional<std::string> field(const std::string& name) const;
};

// Names under which our own files keep what the formats have no field for.
inline constexpr const char* meaning_key = "octotomy_meaning";
inline constexpr const char* modality_key = "octotomy_modality";
inline constexpr const char* padding_key = "octotomy_padding";
/// NIfTI has one free text, the description: this mark, the meaning, the modality, and behind
/// nifti_padding_mark the padding.
inline constexpr std::string_view nifti_mark = "octotomy ";
inline constexpr std::string_view nifti_padding_mark = "padding=";
/// NIfTI-1 keeps positions in single precision. Our own files add them in double precision, in an extension
/// of plain text (code 6, which others skip): this mark, then the first three rows of lps_from_voxel.
inline constexpr std::string_view nifti_geometry_mark = "octotomy lps_from_voxel ";
inline constexpr std::int32_t nifti_text_extension = 6;

/// Reads a header. Throws Error, Input, with path and reason where it is damaged, states what is no scan
/// (more than one value a sample, several volumes), or claims more samples than its files can hold. Memory: a
/// few megabytes.
VolumeHeader read_volume_header(const std::filesystem::path& path, VolumeFormat format);

/// Takes the text of Scene::padding. A text that is no number is passed over with a WARN; nothing is done for
/// none.
void take_padding(const std::optional<std::string>& text, VolumeHeader& header);

/// The audit's line on slope and intercept. `says` names them as the format does.
Finding rescale_finding(const StoredSamples& stored, const std::string& says);
/// Gives a file of two axes its third one: across the first two, 1 mm long, which the audit warns of.
void add_third_axis(VolumeHeader& header);

/// Adds a line to the audit where a spacing of the field `name` has a minus sign, which formats do not
/// foresee.
void warn_of_minus_signs(const char* name, const std::vector<double>& spacings, VolumeHeader& header);

/// As read_volume_header(), of one format.
VolumeHeader read_nifti_header(const std::filesystem::path& path);
VolumeHeader read_nrrd_header(const std::filesystem::path& path);
VolumeHeader read_meta_header(const std::filesystem::path& path);

/// Throws Error, Input, where `axes` numbers of samples along as many axes are no whole numbers from 1 to
/// 2^31 - 1; returns the first three, 1 where there are fewer. More than three axes with more than one sample
/// are refused.
glm::ivec3 dims_of(const std::filesystem::path& path, const std::vector<double>& lengths);

}  // namespace octotomy::voxel
