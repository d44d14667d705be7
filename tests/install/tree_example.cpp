// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The octree alone: it links GLM, TBB, zstd and zlib.
#include <cstdio>
#include <octotomy/version.h>

#include "voxel/tree/build.h"
#include "voxel/tree/octree_file.h"

using namespace octotomy;

/// A scan of 64 x 64 x 64 voxels of 1 mm: 1000 inside a ball of radius 20 about the middle, 0 outside.
voxel::Scene ball_scan() {
  voxel::Scene scan;
  scan.lattice = voxel::axis_aligned_lattice(glm::ivec3(64), glm::dvec3(1), glm::dvec3(0));
  voxel::Int16Samples samples;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        samples.push_back(glm::distance(glm::dvec3(x, y, z), glm::dvec3(31.5)) < 20 ? 1000 : 0);
  scan.samples = samples;
  return scan;
}

int main(int, char** arguments) {
  const voxel::Universe universe{.depth = 6};
  const voxel::Octree ball = voxel::octree_of_window(universe, ball_scan(), 500, 3000);
  voxel::write_octree({ball, "ball", ""}, arguments[1]);
  const voxel::OctreeFile file = voxel::read_octree(arguments[1]);
  const bool same = std::get<voxel::Octree>(file.tree) == ball;
  std::printf("Octotomy %s: %s of %llu voxels\n", OCTOTOMY_VERSION, file.name.c_str(),
              static_cast<unsigned long long>(ball.voxel_count()));
  return same && ball.voxel_count() > 33000 && ball.voxel_count() < 34000 ? 0 : 1;
}
