// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/file/file_kind.h"

#include <algorithm>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <unistd.h>

#include "voxel/space/file_text.h"

namespace octotomy::planner {
namespace {

namespace fs = std::filesystem;

bool has_extension(const fs::path& path, std::initializer_list<const char*> known) {
  const std::string extension = voxel::extension_of(path);
  return std::any_of(known.begin(), known.end(), [&](const char* each) { return extension == each; });
}

}  // namespace

bool is_mesh(const fs::path& path) {
  return has_extension(path, {".stl", ".ply", ".obj", ".off", ".vtk", ".vtp"});
}

bool is_octree(const fs::path& path) {
  return has_extension(path, {".octree"});
}

void need_folder_of(const fs::path& out) {
  const fs::path folder = fs::absolute(out).lexically_normal().parent_path();
  if (!fs::is_directory(folder))
    throw std::runtime_error(out.string() + ": there is no folder " + folder.string() +
                             ": make it, or choose another -o");
  if (::access(folder.c_str(), W_OK) != 0)
    throw std::runtime_error(out.string() + ": " + folder.string() +
                             " cannot be written to: choose another -o");
}

void need_mesh_extension(const fs::path& path) {
  if (!has_extension(path, {".stl", ".ply", ".obj", ".off", ".vtp", ".glb"}))
    throw std::runtime_error(path.string() + ": a mesh is written as .stl, .ply, .obj, .off, .vtp or .glb");
}

void need_octree_extension(const fs::path& out) {
  if (!is_octree(out)) throw std::runtime_error(out.string() + ": an octree is written as .octree");
}

}  // namespace octotomy::planner
