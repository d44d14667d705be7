// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "planner/operation/object/provenance.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/operation.h"

// Moves an object rigidly in each kernel. Every operation that moves objects uses these functions.
namespace octotomy::planner {

/// The positions of marks and the motions of objects, in a plan or in one trial of a plan.
struct MarkPlaces {
  std::function<glm::dvec3(const Mark& mark)> mark_mm;
  glm::dmat3 lps_from_head{1.0};
  std::function<glm::dmat4(const std::string& object)> motion_of;  ///< the motion of the step that made this
                                                                   ///< object
};

/// The positions and motions of a plan's objects. `objects` must outlive the result.
MarkPlaces places_of(const Objects& objects);

/// The motion of a move step if its marks have these positions; none for a step of another operation. Throws
/// std::invalid_argument if the positions do not determine the motion.
std::optional<glm::dmat4> motion_of(const Action& action, const MarkPlaces& places);

void move_voxels(const std::string& object, const glm::dmat4& moved_from_still, const VoxelBench& bench,
                 VoxelSide& made);
void move_triangles(const std::string& object, const glm::dmat4& moved_from_still, const MeshBench& bench,
                    MeshSide& made);

// Functions for operations whose motion is determined before the kernels run. Their values must have the
// members `object` and `moved_from_still`.

template <typename Settled>
void moved_voxels(const Settled& settled, const VoxelBench& bench, VoxelSide& made) {
  move_voxels(settled.object.name, settled.moved_from_still, bench, made);
}
template <typename Settled>
void moved_triangles(const Settled& settled, const MeshBench& bench, MeshSide& made) {
  move_triangles(settled.object.name, settled.moved_from_still, bench, made);
}
template <typename Settled>
void move_bound(const Settled& settled, const BoundBench& bench, Object& made) {
  carry(settled.object.name, settled.moved_from_still, bench, made);
}

}  // namespace octotomy::planner
