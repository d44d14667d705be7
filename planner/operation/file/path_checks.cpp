// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/path_checks.h"

#include <algorithm>
#include <climits>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <sys/statvfs.h>

#include "brep/io/read_mesh.h"
#include "planner/operation/table/control_character.h"
#include "voxel/scan/write_scene.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

/// While a file is written its name is longer, by a process number and ".part".
constexpr std::size_t longest_name = NAME_MAX - 20;

bool has_extension(const fs::path& path, std::initializer_list<const char*> known) {
  const std::string extension = voxel::extension_of(path);
  return std::any_of(known.begin(), known.end(), [&](const char* each) { return extension == each; });
}

}  // namespace

bool is_mesh(const fs::path& path) {
  return brep::is_mesh_file(path);
}

bool is_octree(const fs::path& path) {
  return has_extension(path, {".octree"});
}

void need_folder_of(const fs::path& out, OutputKind kind) {
  const auto refuse = [&](const std::string& why) { throw std::runtime_error(out.string() + ": " + why); };
  if (has_control(out.native())) refuse("has control characters in its name: choose another name");
  if (kind == OutputKind::File && !out.has_filename()) refuse("names a folder: add the file's name");
  const fs::path file = voxel::place_of(out), folder = file.parent_path();
  if (!fs::is_directory(folder))
    refuse("there is no folder " + folder.string() + ": make the folder, or choose another path");
  if (file.filename().native().size() > longest_name ||
      std::max(out.native().size(), file.native().size()) + longest_name > PATH_MAX)
    refuse("is too long a name: choose a shorter one");
  const fs::file_status status = fs::symlink_status(file);
  const bool is_folder = fs::is_directory(status);
  if (fs::exists(status) && !is_folder && !fs::is_regular_file(status))
    refuse("is a pipe or device, which is not replaced: choose another name");
  if (fs::exists(status) && is_folder != (kind == OutputKind::Folder))
    refuse(is_folder ? "is a folder, which is not replaced by a file: choose another name"
                     : "is a file, which is not replaced by a folder: choose another name");
  kind == OutputKind::File ? voxel::need_own_data_file(out) : voxel::need_no_slices(out);
  try {
    const voxel::StagedFiles trial(folder);
  } catch (const voxel::Error& error) {
    throw voxel::Error(error.code(), out.string() + ": " + error.what());
  }
  struct statvfs disk {};
  if (::statvfs(folder.c_str(), &disk) == 0 && disk.f_blocks > 0 && disk.f_bavail == 0)
    throw voxel::Error(voxel::ErrorCode::Resource,
                       out.string() + ": the disk is full: free space, or choose a path on another disk");
}

void need_folder_of(const fs::path& out) {
  need_folder_of(out, OutputKind::File);
}

void need_extension(const fs::path& out, const std::vector<std::string>& extensions,
                    const std::string& what) {
  const std::string name = out.filename().string();
  std::string known;
  for (const std::string& each : extensions) {
    if (name.size() > each.size() && voxel::lower_case(name).ends_with(each)) return;
    known += (known.empty() ? "" : &each == &extensions.back() ? " or " : ", ") + each;
  }
  throw std::runtime_error(out.string() + ": " + what + " written as " + known);
}

void need_mesh_extension(const fs::path& out) {
  need_extension(out, {".stl", ".ply", ".obj", ".off", ".vtp", ".glb"}, "a mesh is");
}

void need_octree_extension(const fs::path& out) {
  need_extension(out, {".octree"}, "an octree is");
}

void need_picture_extension(const fs::path& out) {
  need_extension(out, {".png", ".jpg", ".jpeg", ".webp"}, "a picture is");
}

}  // namespace octotomy::planner
