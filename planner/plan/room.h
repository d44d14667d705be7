// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "planner/operation/table/object.h"
#include "voxel/space/lattice.h"

namespace octotomy::planner {

/// The universe of a plan lies around its first scan. An evaluation in which an object reaches out of it, by a motion
/// or by growing, starts again in a larger one. Thrown to evaluate(), which catches it: no other caller sees it, and
/// no handler of errors catches it, because it is no std::exception. Each box contains the previous box and an object
/// that reached out of it, so the restarts end.
struct NeedsRoom {
  voxel::Box box_mm;  ///< LPS; the universe must contain it
};

/// The universe, enlarged until it contains a box: by whole voxels, so that voxels keep their places and the
/// samples of a scan are not interpolated differently. None if it would take more than four times its side, or
/// more than 2^Universe::max_depth voxels. The same universe if it contains the box.
std::optional<voxel::Universe> with_room(const voxel::Universe& universe, const voxel::Box& box_mm);

/// Throws NeedsRoom if a part of an object lies outside of the universe. The box contains `room`, which earlier
/// objects needed, and the object. `least` is the universe before it was enlarged. If with_room() returns none, a
/// motion or mirror image throws std::runtime_error with the distance; another object keeps its caveat, because a
/// later step may bring it back. Precondition: the caveats of the object are complete (add_caveats()).
void need_room(const Objects& objects, const Object& made, const voxel::Universe& least,
               const std::optional<voxel::Box>& room);

}  // namespace octotomy::planner
