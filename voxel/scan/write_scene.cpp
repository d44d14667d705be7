// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/write_scene.h"

#include "voxel/scan/scene_itk.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"

namespace octotomy::voxel {
namespace {

std::uint64_t bytes_of_sample(const Scene& scene) {
  return std::visit([](const auto& samples) { return sizeof(samples[0]); }, scene.samples);
}

}  // namespace

std::uint64_t least_file_bytes(const Lattice& lattice, std::uint64_t sample_bytes,
                               const std::filesystem::path& path) {
  const std::optional<VolumeFormat> format = volume_format(path);
  const std::uint64_t bytes = lattice.sample_count() * (format ? sample_bytes : sizeof(std::int16_t));
  // ITK writes NIfTI unpacked before it is packed.
  return format && *format != VolumeFormat::Nifti ? bytes / deflate_ratio : bytes;
}

void write_scene(const Scene& scene, const std::filesystem::path& path) {
  check(scene);
  const std::optional<VolumeFormat> format = volume_format(path);
  if (!format)
    refuse(path, "no scan format has this extension; choose .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd");
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
