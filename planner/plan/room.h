// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "planner/operation/table/object.h"
#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// Thrown if an object reaches out of the universe, by a motion or by growing. Only evaluate() catches it and
/// starts again in a larger universe. It is no std::exception, so that no handler of errors catches it. Its
/// box contains the previous one and the object, so the universe grows only a few times.
struct NeedsRoom {
  voxel::Box box_mm;  ///< in LPS; the next universe must contain it
};

/// The universe, enlarged by whole voxels until it contains a box. Voxels keep their places, so that a scan
/// is not sampled differently. Returns the same universe if it contains the box. None if the side would be
/// more than four times as long, or more than 2^Universe::max_depth voxels.
std::optional<voxel::Universe> with_room(const voxel::Universe& universe, const voxel::Box& box_mm);

/// Throws NeedsRoom if a part of an object lies outside of the universe. The box of NeedsRoom contains the
/// object and `room`, which earlier objects needed. `least` is the universe before it was enlarged. If
/// with_room() returns none, throws std::runtime_error with the distance for a motion or mirror image. Other
/// objects then keep their caveat, because a later step may bring the part back. Precondition: add_caveats()
/// has been called for the object.
void need_room(const Objects& objects, const Object& made, const voxel::Universe& least,
               const std::optional<voxel::Box>& room);

}  // namespace octotomy::planner
