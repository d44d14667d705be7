// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "planner/operation/object/trace.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/operation.h"

// An object under a rigid motion in each kernel, for every operation that moves one.
namespace octotomy::planner {

/// Where marks lie and how objects moved: in a plan, or in a trial of one.
struct MarkPlaces {
  std::function<glm::dvec3(const Mark& mark)> mark_mm;
  glm::dmat3 lps_from_head{1.0};
  std::function<glm::dmat4(const std::string& object)> motion_of;  ///< of the step that moved it
};

/// Those of a plan's objects, which must outlive the answer.
MarkPlaces places_of(const Objects& objects);

/// The motion that a move has with marks at these places; none of a step of another operation. Throws
/// std::invalid_argument where the places leave it open.
std::optional<glm::dmat4> motion_of(const Action& action, const MarkPlaces& places);

void move_voxels(const std::string& object, const glm::dmat4& moved_from_still, const VoxelBench& bench,
                 VoxelSide& made);
void move_triangles(const std::string& object, const glm::dmat4& moved_from_still, const MeshBench& bench,
                    MeshSide& made);

// What an operation does whose motion was settled: its value says `object` and `moved_from_still`.

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
