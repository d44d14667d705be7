// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// An object that elements are attached to: its voxels at that time, and its motion by the plan.
struct Holder {
  std::string id;
  voxel::Octree octree;
  std::optional<glm::dmat4> motion;  ///< LPS to LPS, by all the steps that moved it; none: it is fixed
};
/// The holders of a step, moved ones first. A moved object has the voxels from before all of its motions.
std::vector<Holder> holders_of(const Objects& objects, const Deck& step);

/// Adds the displacements of a deck's nodes as a static step. A holder that is one of the deck's regions,
/// `names`, moves all nodes of that region; another holder moves the boundary's nodes on its voxels. A node
/// on two holders moves with the first. Adds node sets MOVED_<holder> and FIXED_<holder>. Faces on holders
/// outside of the deck are moved from their surface to ON_<holder>. Parts without any holder would be free to
/// move, so they are left out, with a finding on their volume. Returns findings. Throws std::runtime_error
/// where a holder holds no node. Precondition: boundary elements end at voxels' corners, or all holders are
/// regions.
std::vector<std::string> attach(const std::vector<Holder>& holders, const std::vector<std::string>& names,
                                convert::Tetrahedra& tetrahedra, convert::DeckOptions& options);

}  // namespace octotomy::planner
