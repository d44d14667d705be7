// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/octree_in.h"

#include <array>
#include <fstream>

#include "planner/operation/file/path_checks.h"

namespace octotomy::planner {

std::optional<OctreeKind> octree_kind(const std::filesystem::path& path) {
  std::error_code failed;
  if (!is_octree(path) || !std::filesystem::is_regular_file(path, failed)) return std::nullopt;
  std::array<char, 16> header{};
  if (!std::ifstream(path, std::ios::binary).read(header.data(), header.size())) return std::nullopt;
  // The file's kind is a little-endian u32 after the magic and the version (octree_file.h).
  switch (header[12]) {
    case 1:
      return OctreeKind::Binary;
    case 2:
      return OctreeKind::Grey;
    case 3:
      return OctreeKind::Partial;
    default:
      return std::nullopt;
  }
}

voxel::OctreeFile read_timed(const std::filesystem::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  return voxel::read_octree(path);
}

}  // namespace octotomy::planner
