// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// An object to which elements are attached: its voxels before all motions of the plan, and their combined
/// motion.
struct Holder {
  std::string id;
  voxel::Octree octree;
  std::optional<glm::dmat4> motion;  ///< LPS to LPS, by all steps that moved the object; none: the object is
                                     ///< fixed
};
/// The holders that a step names, the moved ones first.
std::vector<Holder> holders_of(const Objects& objects, const Deck& step);

/// Prescribes the displacements of a deck's nodes in a static step. `names` are the deck's regions. A holder
/// that is a region moves all nodes of that region; another holder moves the boundary's nodes on its voxels.
/// A node on two holders moves with the first. Adds the node sets MOVED_<holder> and FIXED_<holder>. Faces on
/// holders outside of the deck change from their surface to the surface ON_<holder>. Parts without any holder
/// could move freely, so they are removed; a finding states their volume. Returns the findings. Throws
/// std::runtime_error if a holder has no node. Precondition: boundary elements end at voxels' corners, or all
/// holders are regions.
std::vector<std::string> attach(const std::vector<Holder>& holders, const std::vector<std::string>& names,
                                convert::Tetrahedra& tetrahedra, convert::DeckOptions& options);

}  // namespace octotomy::planner
