// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/octree_in.h"

namespace octotomy::planner {

voxel::OctreeFile read_timed(const std::filesystem::path& path, Timings& timings) {
  const Stopwatch watch(timings, "read");
  return voxel::read_octree(path);
}

}  // namespace octotomy::planner
