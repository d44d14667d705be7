// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// An object that elements are attached to, as it lay when they were, and where the plan takes it.
struct Holder {
  std::string id;
  voxel::Octree octree;
  std::optional<glm::dmat4> motion;  ///< LPS to LPS, by all the steps that moved it; none: it stays
};
/// Those of a step, moved ones first. A result of move steps holds as the object lay before them all.
std::vector<Holder> holders_of(const Objects& objects, const Deck& step);

/// Holds and moves a deck's elements as its step says, in a static step: a holder that is one of the deck's
/// regions, `names`, takes all of that region's nodes along, another one the boundary's nodes that lie on its
/// voxels. A node on two holders goes with the first. Adds node sets MOVED_<holder> and FIXED_<holder>; faces
/// that lie on holders outside of the deck leave their surface for ON_<holder>. Parts that nothing holds
/// would float: they are left out, as a finding with their volume. Answers findings. Throws
/// std::runtime_error where a holder holds no node. Precondition: boundary elements end at voxels' corners,
/// or all holders are regions.
std::vector<std::string> attach(const std::vector<Holder>& holders, const std::vector<std::string>& names,
                                convert::Tetrahedra& tetrahedra, convert::DeckOptions& options);

}  // namespace octotomy::planner
