// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/write_scene.h"

#include "voxel/scan/label_overlaps.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"
#include "voxel/volume/volume_header.h"
#include "voxel/volume/write_volume.h"

namespace octotomy::voxel {
namespace {

std::uint64_t bytes_of_sample(const Scene& scene) {
  return std::visit([](const auto& samples) { return sizeof(samples[0]); }, scene.samples);
}

/// The path of the data file for a header's compressed samples; none for formats that store samples in the
/// header's file.
std::optional<std::filesystem::path> data_file_beside(std::filesystem::path header) {
  const std::string extension = extension_of(header);
  if (extension == ".nhdr") return header.replace_extension(".raw.gz");
  if (extension == ".mhd") return header.replace_extension(".zraw");
  return std::nullopt;
}

/// The path of a header from which the `count`-th candidate for the data file's name is derived.
std::filesystem::path header_of_try(const std::filesystem::path& path, int count) {
  if (count == 1) return path;
  return path.parent_path() /
         (path.stem().string() + ".samples-" + std::to_string(count) + path.extension().string());
}

/// Whether a data file has one of the candidate names for this header.
bool has_own_name(const std::filesystem::path& data, const std::filesystem::path& header) {
  const std::string name = data.filename().string();
  const std::string first = data_file_beside(header)->filename().string(), stem = header.stem().string();
  return name == first || (name.starts_with(stem + ".samples-") && name.ends_with(first.substr(stem.size())));
}

bool is_there(const std::filesystem::path& path) {
  return std::filesystem::exists(std::filesystem::symlink_status(path));
}

}  // namespace

std::uint64_t least_file_bytes(const Lattice& lattice, std::uint64_t sample_bytes,
                               const std::filesystem::path& path) {
  const std::optional<VolumeFormat> format = volume_format(path);
  const std::uint64_t bytes = lattice.sample_count() * (format ? sample_bytes : sizeof(std::int16_t));
  return format && extension_of(path) != ".nii" ? bytes / deflate_ratio : bytes;
}

std::optional<std::filesystem::path> own_data_file(const std::filesystem::path& path) {
  if (!data_file_beside(path)) return std::nullopt;
  try {
    if (!std::filesystem::is_regular_file(path)) return std::nullopt;
    const VolumeHeader header = read_volume_header(path, *volume_format(path));
    if (header.samples.files.size() != 1) return std::nullopt;
    const std::filesystem::path& named = header.samples.files.front();
    const std::filesystem::path own = std::filesystem::absolute(path).parent_path() / named.filename();
    std::error_code is_none;
    if (has_own_name(named, path) && std::filesystem::equivalent(named, own, is_none)) return own;
  } catch (const std::runtime_error&) {  // a damaged header names no data file
  }
  return std::nullopt;
}

void need_own_data_file(const std::filesystem::path& path) {
  const std::optional<std::filesystem::path> data = data_file_beside(path);
  if (!data) return;
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(path)))
    refuse(path,
           "is a link, so the samples would be written beside the link and not beside the header: name the "
           "file itself");
  if (!is_there(*data) || own_data_file(path)) return;
  refuse(path, "the name of its samples is used by " + data->string() +
                   ", which is not this header's: move that file away, or choose another name");
}

std::filesystem::path staged_scene_name(const std::filesystem::path& path) {
  for (int count = 1;; ++count) {
    const std::filesystem::path header = header_of_try(path, count);
    const std::optional<std::filesystem::path> data = data_file_beside(header);
    if (!data || !is_there(*data)) return header.filename();
  }
}

void write_scene(const Scene& scene, const std::filesystem::path& path) {
  check(scene);
  if (!scene.overlaps.empty()) return write_scene(with_lowest_labels(scene), path);
  const std::optional<VolumeFormat> format = volume_format(path);
  if (!format)
    refuse(path, "no scan format has this extension; choose .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd");
  need_own_data_file(path);
  need_disk(path, least_file_bytes(scene.lattice, bytes_of_sample(scene), path));
  StagedFiles staging(path.parent_path());
  const std::filesystem::path staged = staging.folder() / staged_scene_name(path);
  try {
    write_volume(scene, staged, *format);
  } catch (const Error& error) {
    std::string reason = error.what();  // the staged header's name begins with the temporary name
    if (reason.starts_with(staged.string())) reason.erase(0, staged.string().size());
    throw Error(error.code(), path.string() + reason);
  }
  const std::optional<std::filesystem::path> older = own_data_file(path);
  std::filesystem::rename(staged, staging.folder() / path.filename());
  staging.commit(path.filename());
  std::error_code stays;
  if (older) std::filesystem::remove(*older, stays);
}

}  // namespace octotomy::voxel
