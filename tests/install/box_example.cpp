// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Both kernels: a box of voxels, its boundary as a mesh, and the mesher that the installation brings.
#include <cmath>
#include <cstdio>

#include "brep/mesh/measure.h"
#include "convert/surface/cuberille.h"
#include "voxel/space/helper_file.h"
#include "voxel/tree/octree.h"

using namespace octotomy;

int main() {
  const voxel::Octree box = voxel::Octree::full(voxel::Universe{.depth = 4});
  const double volume_mm3 = brep::size_of(convert::triangles_of(convert::cuberille(box))).volume_mm3;
  const std::string mesher = voxel::helper_file("octotomy-tetgen").string();
  std::printf("%g cubic millimetres; tetrahedra by %s\n", volume_mm3, mesher.c_str());
  return std::abs(volume_mm3 - 4096) < 1e-9 ? 0 : 1;
}
