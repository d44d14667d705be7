// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

namespace octotomy::voxel {

struct BoardOptions {
  double threshold = -300.0;  ///< samples of at least this value are solid, HU
  double thick_mm = 30.0;     ///< above 0: profiles that hold a larger square are no board
};

/// A support that runs through the scan.
struct Board {
  Octree solid;  ///< its solid voxels, on universe_on() of the scene's lattice
  double volume_mm3 = 0.0, thick_mm = 0.0, wide_mm = 0.0;  ///< of the widest profile
};

/// The parts that look the same on nine of ten slices across the lattice's axis nearest to the patient's:
/// boards, couches, cradles and their skins, flat, curved or hollow, flush with the patient or not. A head
/// looks different on each slice, so that the board ends where the head begins. Profiles narrower than 40 mm
/// or three times their thickness, before the middle of what is solid, thicker than the limit or more than
/// half of all that is solid are the patient's. None where there is no such part: supports that end within
/// the scan are not found. Throws std::invalid_argument if samples are not int16. Cost: linear.
std::optional<Board> board_of(const Scene& scene, const BoardOptions& options = {});

}  // namespace octotomy::voxel
