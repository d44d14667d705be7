// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/deck.h"
#include "planner/evaluate.h"
#include "voxel/progress.h"

namespace octotomy::planner {

/// An object as finite elements that other objects hold and move: soft tissue on bone.
struct Attached {
  convert::Tetrahedra tetrahedra;
  std::vector<convert::NodeSet> node_sets;      ///< MOVED_<object>, FIXED_<object>
  std::vector<convert::DeckSurface> surfaces;   ///< ON_<object> where an object holds it, FREE elsewhere
  std::vector<convert::Prescribed> prescribed;  ///< what the plan moves, node by node, and what it holds fast
  std::vector<std::string> findings;
};

/// Fills an object by an octree's tetrahedra and prescribes how its nodes move that lie on the objects it is
/// attached to: a result of move steps takes the nodes on the object as it lay before them along by all their
/// motions; the nodes on an object that stays are held. A node on two objects goes with the first of the
/// step's list, moved ones first. Nodes lie on voxels' corners, so that what an object holds is exact to the
/// universe's voxels, or to those of `element_mm`. Parts that no object holds would float: they are left out,
/// as a finding with their volume. Throws std::runtime_error where an object of the list holds no node.
/// Throws Stopped where `progress` asks for it.
Attached attach(const Evaluation& evaluation, const Object& object, const Attachment& attachment,
                const voxel::Progress& progress = {});

}  // namespace octotomy::planner
