// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/read_scene.h"

#include <stdexcept>

#include "voxel/read_dicom.h"
#include "voxel/scene_itk.h"

namespace octotomy::voxel {

Scene read_scene(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw std::runtime_error(path.string() + ": no such file or folder");
  const bool is_folder = std::filesystem::is_directory(status);
  const std::optional<VolumeFormat> format = volume_format(path);
  Scene scene = !is_folder && format ? read_volume_file(path, *format) : read_dicom(path);
  try {
    check(scene);
  } catch (const std::invalid_argument& flaw) {
    throw std::runtime_error(path.string() + ": the header's geometry is unusable: " + flaw.what());
  }
  return scene;
}

}  // namespace octotomy::voxel
