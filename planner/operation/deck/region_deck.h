// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/table/object.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {

/// Several objects as regions of one deck, or one that others hold and move.
struct RegionDeck {
  convert::Tetrahedra tetrahedra;
  convert::DeckOptions options;  ///< materials, sets, surfaces, contacts and what is prescribed
  bool fallback = false;         ///< the elements are the voxels', where smooth ones were asked for
  std::vector<std::string> findings;
};

/// Fills an object and the step's regions: by their voxels' elements, or by smooth ones of the size that the
/// step asks for (convert::smooth_tetrahedra_of()), and by the former, marked, where that fails and the step
/// allows the fallback. A region that the step lists as moved is taken as it lay before its motions.
///
/// Each has the step's material for it; without, an object that others hold is soft tissue, and so are the
/// regions beside it that hold nothing; whatever else there is is cortical bone, which is a finding but of
/// what moves as a whole. Surfaces are FREE_<object> where nothing touches it, FREE where it is alone, and
/// <one>_TO_<other> where they touch, as the first's faces. Where the step wants contact, or its pairs slide,
/// regions have nodes of their own there, the other's faces are the surface <other>_TO_<one>, and the two are
/// a contact pair of the first's name, the softer one its slave; faces at a slit's end, which share a node,
/// are in neither. Who holds and moves it, and how, is attach()'s.
///
/// Throws std::runtime_error where there is no filling, a pair that is to slide does not touch, or a holder
/// holds nothing, Stopped where `progress` asks for it.
RegionDeck region_deck(const Objects& objects, const Object& object, const Deck& step,
                       const voxel::Progress& progress = {});

}  // namespace octotomy::planner
