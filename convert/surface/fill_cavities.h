// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>

#include "brep/mesh/solid.h"

namespace octotomy::convert {

/// A solid without its small cavities.
struct FilledCavities {
  brep::Solid solid;
  std::size_t cavities = 0;  ///< filled ones
  double volume_mm3 = 0.0;   ///< of all filled cavities
};

/// Fills the cavities of a solid that are smaller than a volume: connected shells that are inside out. A
/// single sample just outside the window gives an isosurface an octahedral cavity as small as a thousandth of
/// a voxel. The scan shows nothing there, yet a mesher that keeps the surface makes flat elements beside the
/// cavity, and a mesher that makes its own surface loses the cavity. Precondition: no body lies within a
/// cavity that is filled. Throws std::invalid_argument if the volume is not positive. Cost: linear.
FilledCavities fill_cavities(const brep::Solid& solid, double smaller_than_mm3);

}  // namespace octotomy::convert
