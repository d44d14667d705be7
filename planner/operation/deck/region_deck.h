// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/deck/deck.h"
#include "planner/operation/deck/deck_step.h"
#include "planner/operation/table/object.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {

/// A deck whose regions are several objects, or one object that others hold and move.
struct RegionDeck {
  convert::Tetrahedra tetrahedra;
  convert::DeckOptions options;  ///< materials, sets, surfaces, contacts and prescribed displacements
  bool fallback = false;         ///< smooth elements were requested, but failed; the elements are voxels
  std::vector<std::string> findings;
};

/// Fills an object and the step's regions with elements. By default each voxel becomes elements; if the step
/// states a size, the elements are smooth (convert::smooth_tetrahedra_of()). If smooth elements fail and the
/// step allows the fallback, voxels are used and `fallback` is set. A region that the step lists as moved is
/// filled at its position before its motions.
///
/// A single region is soft tissue. Each of several regions has the material that the step states for it. If
/// none is stated and the step has holders (`moved` or `fixed`), a holder is cortical bone and all other
/// regions are soft tissue. If the step has no holders, cortical bone is assumed, which is reported as a
/// finding.
///
/// The surface FREE_<object>, or FREE for a single object, is where the object touches no other. The surface
/// <one>_TO_<other> is where two objects touch, as faces of the first. If the two slide, each has separate
/// nodes there, and <other>_TO_<one> has the second's faces. The two surfaces form a contact pair with the
/// name <one>_TO_<other>; its slave is the softer side. Faces whose two sides share a node, at the end of a
/// slit, are in neither surface. attach() adds the node sets that hold and move the object.
///
/// Throws std::runtime_error where the filling fails, a sliding pair does not touch, or a holder holds
/// nothing; Stopped where `progress` requests it.
RegionDeck region_deck(const Objects& objects, const Object& object, const Deck& step,
                       const voxel::Progress& progress = {});

}  // namespace octotomy::planner
