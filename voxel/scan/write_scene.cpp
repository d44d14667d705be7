// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/write_scene.h"

#include "voxel/scan/scene_itk.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"

namespace octotomy::voxel {

void write_scene(const Scene& scene, const std::filesystem::path& path) {
  check(scene);
  const std::optional<VolumeFormat> format = volume_format(path);
  if (!format)
    refuse(path, "no scan format has this extension; choose .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd");
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
