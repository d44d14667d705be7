// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// Volume files that ITK reads and writes; ITK's physical space is LPS.
enum class VolumeFormat { Nifti, Nrrd, Meta };

/// By the file name's extension, whatever its case; none where it is no volume file's.
std::optional<VolumeFormat> volume_format(const std::filesystem::path& path);

/// The format's name, for people.
const char* name_of(VolumeFormat format);

/// What a volume file says before its samples.
struct VolumeHeader {
  /// Fields of a NRRD or MetaImage by key in lower case; empty for NIfTI.
  std::map<std::string, std::string> fields;
  /// Of a NIfTI of ours, which adds what single precision rounds off: see nifti_geometry_mark.
  std::optional<glm::dmat4> lps_from_voxel;
  /// Most bytes of samples that its data can hold: their size where raw, 1100 times that where packed.
  std::uintmax_t most_bytes = 0;
  std::filesystem::path data_file;  ///< that holds the samples; empty where they are of several
  std::uintmax_t sample_bytes = 0;  ///< of a NIfTI as it stands, before its rescale
  std::uintmax_t data_at = 0;       ///< where samples begin: in the file, of a packed NIfTI when unpacked

  std::optional<std::string> field(const std::string& key) const;
};

/// NIfTI-1 keeps places in single precision. Ours hold them in double precision as well, in an extension of
/// plain text (code 6, which others skip): this mark, then the first three rows of lps_from_voxel.
inline constexpr std::string_view nifti_geometry_mark = "octotomy lps_from_voxel ";
inline constexpr std::int32_t nifti_text_extension = 6;

/// Reads a header and refuses what the libraries behind ITK never return from or write beyond their buffers
/// on. Throws std::runtime_error with path and reason.
VolumeHeader read_volume_header(const std::filesystem::path& path, VolumeFormat format);

/// Refuses a file whose samples are cut short or damaged, which the libraries behind ITK read in part as
/// whatever memory held before. Throws std::runtime_error with path and reason. Cost: packed
/// samples are unpacked once, into nothing.
void require_samples(const std::filesystem::path& path, VolumeFormat format, const VolumeHeader& header,
                     std::uintmax_t bytes);

}  // namespace octotomy::voxel
