// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace octotomy::voxel {

/// Volume files that ITK reads and writes; ITK's physical space is LPS.
enum class VolumeFormat { Nifti, Nrrd, Meta };

/// The format by the file name's extension, in upper or lower case; none for another extension.
std::optional<VolumeFormat> volume_format(const std::filesystem::path& path);

/// The format's name in messages.
const char* name_of(VolumeFormat format);

/// The header of a volume file.
struct VolumeHeader {
  /// Fields of a NRRD or MetaImage by key in lower case; empty for NIfTI.
  std::map<std::string, std::string> fields;
  /// The double-precision geometry that our own NIfTI files add; see nifti_geometry_mark.
  std::optional<glm::dmat4> lps_from_voxel;
  /// Upper bound on the bytes of samples: the data's size if raw, 1100 times that if packed.
  std::uintmax_t most_bytes = 0;
  std::filesystem::path data_file;  ///< holds the samples; empty if several files do
  std::uintmax_t sample_bytes = 0;  ///< of one stored sample, before rescale; NIfTI only
  std::uintmax_t data_at = 0;       ///< offset of the samples in the file; in the unpacked one for .nii.gz
  bool is_packed = false;           ///< the samples, or the whole .nii.gz, are deflated
  /// The samples stand in `data_file` in this machine's byte order and as they are meant.
  bool is_plain = false;

  std::optional<std::string> field(const std::string& key) const;
};

/// NIfTI-1 keeps positions in single precision. Our own files add them in double precision, in an extension
/// of plain text (code 6, which others skip): this mark, then the first three rows of lps_from_voxel.
inline constexpr std::string_view nifti_geometry_mark = "octotomy lps_from_voxel ";
inline constexpr std::int32_t nifti_text_extension = 6;

/// Reads a header and refuses those on which the libraries behind ITK hang or write beyond their buffers.
/// Throws Error, Input, with path and reason.
VolumeHeader read_volume_header(const std::filesystem::path& path, VolumeFormat format);

/// Reads `bytes` bytes of samples; calls `held`, if any, with the count of those that are final, every few
/// megabytes before the last ones. Precondition: they are plain. Throws Error, Input, with path and reason
/// where they are cut short or damaged. Cost: reads and unpacks the file once.
void read_plain_samples(const std::filesystem::path& path, VolumeFormat format, const VolumeHeader& header,
                        char* samples, std::uintmax_t bytes,
                        const std::function<void(std::uintmax_t held)>& held);

/// Refuses a file whose samples are cut short or damaged, for which the libraries behind ITK return
/// uninitialised memory. Throws as read_plain_samples(). Cost: unpacks packed samples once.
void require_samples(const std::filesystem::path& path, VolumeFormat format, const VolumeHeader& header,
                     std::uintmax_t bytes);

}  // namespace octotomy::voxel
