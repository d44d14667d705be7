// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Volumes, in mm3, of the regions where each of two surfaces has a non-zero winding, and of their common
/// part.
struct LineVolume {
  double a_mm3 = 0.0, b_mm3 = 0.0, common_mm3 = 0.0;
};

struct LineVolumes {
  LineVolume all;
  std::array<LineVolume, 2> halves;  ///< volumes from the even and from the odd lines; their difference
                                     ///< estimates the error
  std::size_t lines = 0;             ///< lines that cross a surface
  std::size_t open_lines = 0;        ///< of these, the lines that were left out because they pass a hole or
                                     ///< contradictory triangles
};

/// Volumes by lines along x: about `lines` lines through both surfaces' box, or fewer if this number would
/// cross the surfaces more than 2^26 times. Each line is evaluated exactly: triangles may cross and coincide,
/// and whole shells may face inward. The common volume of a surface with itself is exactly its volume.
/// Precondition: triangles refer to finite points. The same bits on any number of threads. Error: falls with
/// about the 0.75th power of the number of lines; 1e-5 at a million on a head. Cost: proportional to the
/// number of crossings; 0.15 s for a million lines and two surfaces of 500k triangles on two cores.
LineVolumes line_volumes(const Triangles& a, const Triangles& b, std::size_t lines = 1u << 20);

}  // namespace octotomy::brep
