// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/read_scene.h"

#include <stdexcept>

#include "voxel/scan/read_dicom.h"
#include "voxel/scan/read_image_stack.h"
#include "voxel/scan/read_nifti2.h"
#include "voxel/scan/read_raw.h"
#include "voxel/scan/scene_itk.h"
#include "voxel/space/regular_file.h"

namespace octotomy::voxel {
namespace {

namespace fs = std::filesystem;

Scene read_any(const fs::path& path, const ReadOptions& options) {
  if (!fs::is_directory(path)) need_regular_file(path);
  if (options.raw) return read_raw(path, options);
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  const bool is_folder = fs::is_directory(status);
  if (!is_folder) {
    if (!image_files(path).empty()) return read_image_stack(path, options);
    if (!fs::exists(status)) refuse(path, "no such file or folder");
    const std::optional<VolumeFormat> format = volume_format(path);
    if (!format) return read_dicom(path, options);
    if (format == VolumeFormat::Nifti && is_nifti2(path)) return read_nifti2(path);
    return read_volume_file(path, *format);
  }
  // A folder of images may hold DICOM as well. DICOM comes first because it holds positions.
  if (image_files(path).empty()) return read_dicom(path, options);
  try {
    return read_dicom(path, options);
  } catch (const Error& refusal) {
    if (refusal.code() != ErrorCode::Input) throw;
    return read_image_stack(path, options);
  }
}

}  // namespace

Scene read_scene(const fs::path& path, const ReadOptions& options) {
  Scene scene = read_any(path, options);
  try {
    check(scene);
  } catch (const std::invalid_argument& flaw) {
    refuse(path, std::string("the header's geometry is unusable: ") + flaw.what());
  }
  options.progress.at(1.0);
  return scene;
}

}  // namespace octotomy::voxel
