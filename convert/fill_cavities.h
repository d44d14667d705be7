// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "brep/mesh.h"

namespace octotomy::convert {

/// A solid without its small cavities.
struct Filled {
  brep::Mesh mesh;
  std::size_t cavities = 0;  ///< that were filled
  double volume_mm3 = 0.0;   ///< of all of them
};

/// Fills the cavities of a solid that are smaller than a volume: shells that hang together by their triangles
/// and are inside out. Where a sample of a scan is just beyond the threshold and its neighbours are not, an
/// isosurface has a cavity of an octahedron about it, as small as a thousandth of a voxel. The scan shows
/// nothing there, yet a mesher that keeps the surface has flat elements between it and whatever is near, and
/// one that makes its own loses it. Preconditions: closed, and no body within such a cavity. Throws
/// std::invalid_argument where the volume is not positive. Cost: linear.
Filled fill_cavities(const brep::Mesh& solid, double smaller_than_mm3);

}  // namespace octotomy::convert
