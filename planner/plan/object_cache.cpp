// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/object_cache.h"

#include <filesystem>
#include <set>

#include "voxel/scan/read_image_stack.h"
#include "voxel/space/staged_files.h"

namespace octotomy::planner {
namespace {

/// Memory for each triangle of a solid, in bytes: 36 for the triangle, 150 in the search tree, and about 100
/// in the mesh (a face, three halfedges of 16 bytes, and half a vertex with point, normal and status).
constexpr std::uint64_t triangle_bytes = 36 + 150 + 100;

std::uint64_t bytes_of(const std::optional<brep::Solid>& solid) {
  return solid ? triangle_bytes * solid->triangles().faces.size() : 0;
}

}  // namespace

std::uint64_t ObjectCache::bytes_of(const Object& object) {
  const MeshSide& mesh = object.mesh;
  std::uint64_t bytes = sizeof(Object) + bytes_memory(object.voxel.octree) + planner::bytes_of(mesh.whole);
  if (!mesh.whole || !mesh.within || !mesh.within->is_same(*mesh.whole))
    bytes += planner::bytes_of(mesh.within);
  for (const CutWall& wall : object.walls) bytes += planner::bytes_of(wall.wall);
  return bytes;
}

std::uint64_t ObjectCache::bytes_of(const Scan& scan) {
  const auto of_samples = [](const auto& samples) { return samples.size() * sizeof(samples[0]); };
  return scan.loaded.grey.bytes_memory() + std::visit(of_samples, scan.loaded.scene().samples);
}

std::optional<std::string> ObjectCache::sum(const std::string& state) const {
  const std::lock_guard lock(mutex_);
  const auto found = sums_.find(state);
  return found == sums_.end() ? std::nullopt : std::optional(found->second);
}

void ObjectCache::keep_sum(const std::string& state, const std::string& sha256) {
  const std::lock_guard lock(mutex_);
  sums_.insert_or_assign(state, sha256);
}

ObjectCache::Counts ObjectCache::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::string state_of_path(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::set<fs::path> files;
  if (fs::is_directory(path)) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
      if (entry.is_regular_file()) files.insert(entry.path());
  } else if (fs::exists(path)) {
    files.insert(path);
  } else {
    for (const fs::path& file : voxel::image_files(path)) files.insert(file);
  }
  std::string state = voxel::absolute_of(path).string();
  for (const fs::path& file : files)
    state += "\n" + file.string() + " " + std::to_string(fs::file_size(file)) + " " +
             std::to_string(fs::last_write_time(file).time_since_epoch().count());
  return state;
}

}  // namespace octotomy::planner
