// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/table/bench.h"

// An object under a rigid motion in each kernel, for every operation that moves one.
namespace octotomy::planner {

void move_voxels(const std::string& object, const glm::dmat4& moved_from_still, const VoxelBench& bench,
                 VoxelSide& made);
void move_triangles(const std::string& object, const glm::dmat4& moved_from_still, const MeshBench& bench,
                    MeshSide& made);

}  // namespace octotomy::planner
