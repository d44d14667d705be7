// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/write_scene.h"

#include <stdexcept>

#include "voxel/scene_itk.h"
#include "voxel/staging.h"

namespace octotomy::voxel {

void write_scene(const Scene& scene, const std::filesystem::path& path) {
  check(scene);
  const std::optional<VolumeFormat> format = volume_format(path);
  if (!format)
    throw std::runtime_error(
        path.string() +
        ": no scan is written under this extension; choose .nrrd, .nhdr, .nii, .nii.gz, .mha "
        "or .mhd");
  Staging staging(path.parent_path());
  const std::filesystem::path staged = staging.folder() / path.filename();
  try {
    write_volume_file(scene, staged, *format);
  } catch (const std::runtime_error& error) {
    std::string reason = error.what();  // begins with a name that the caller never gave
    if (reason.starts_with(staged.string())) reason.erase(0, staged.string().size());
    throw std::runtime_error(path.string() + reason);
  }
  staging.commit(path.filename());
}

}  // namespace octotomy::voxel
