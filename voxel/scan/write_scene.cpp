// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/write_scene.h"

#include "voxel/scan/scene_itk.h"
#include "voxel/scan/volume_header.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"

namespace octotomy::voxel {
namespace {

std::uint64_t bytes_of_sample(const Scene& scene) {
  return std::visit([](const auto& samples) { return sizeof(samples[0]); }, scene.samples);
}

/// The file that ITK puts packed samples into; none where they stand in the header's own file.
std::optional<std::filesystem::path> data_file_beside(std::filesystem::path header) {
  const std::string extension = extension_of(header);
  if (extension == ".nhdr") return header.replace_extension(".raw.gz");
  if (extension == ".mhd") return header.replace_extension(".zraw");
  return std::nullopt;
}

/// Whether the header that is there says that its samples are in `data`.
bool names(const std::filesystem::path& header, const std::filesystem::path& data) {
  try {
    std::error_code is_none;
    return std::filesystem::is_regular_file(header) &&
           std::filesystem::equivalent(read_volume_header(header, *volume_format(header)).data_file, data,
                                       is_none);
  } catch (const std::runtime_error&) {  // a damaged header names nothing
    return false;
  }
}

}  // namespace

std::uint64_t least_file_bytes(const Lattice& lattice, std::uint64_t sample_bytes,
                               const std::filesystem::path& path) {
  const std::optional<VolumeFormat> format = volume_format(path);
  const std::uint64_t bytes = lattice.sample_count() * (format ? sample_bytes : sizeof(std::int16_t));
  // ITK writes NIfTI unpacked before it is packed.
  return format && *format != VolumeFormat::Nifti ? bytes / deflate_ratio : bytes;
}

void need_own_data_file(const std::filesystem::path& path) {
  const std::optional<std::filesystem::path> data = data_file_beside(path);
  if (!data) return;
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(path)))
    refuse(path, "is a link, beside which its samples would lie apart from the header: name the file itself");
  if (!std::filesystem::exists(std::filesystem::symlink_status(*data)) || names(path, *data)) return;
  refuse(path, "its samples would replace " + data->string() +
                   ", which is not this header's: move that file away, or choose another name");
}

void write_scene(const Scene& scene, const std::filesystem::path& path) {
  check(scene);
  const std::optional<VolumeFormat> format = volume_format(path);
  if (!format)
    refuse(path, "no scan format has this extension; choose .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd");
  need_own_data_file(path);
  need_disk(path, least_file_bytes(scene.lattice, bytes_of_sample(scene), path));
  StagedFiles staging(path.parent_path());
  const std::filesystem::path staged = staging.folder() / path.filename();
  try {
    write_volume_file(scene, staged, *format);
  } catch (const Error& error) {
    std::string reason = error.what();  // begins with the temporary name
    if (reason.starts_with(staged.string())) reason.erase(0, staged.string().size());
    throw Error(error.code(), path.string() + reason);
  }
  staging.commit(path.filename());
}

}  // namespace octotomy::voxel
