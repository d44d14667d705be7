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
  bool fallback = false;         ///< smooth elements were requested, but the elements are the voxels'
  std::vector<std::string> findings;
};

/// Fills an object and the step's regions with elements: their voxels' elements, or smooth elements of the
/// step's size (convert::smooth_tetrahedra_of()). Where the smooth ones fail and the step allows the
/// fallback, the voxels' elements are used and `fallback` is set. A region that the step lists as moved lies
/// where it was before its motions.
///
/// Each region has the material that the step states for it. Without one, a held object is soft tissue, and
/// so are its neighbours that hold nothing. Every other region is cortical bone; this is a finding, unless
/// the region holds the object and therefore moves as a rigid body.
///
/// The surface FREE_<object>, or FREE for a single object, is where the object touches no other. The surface
/// <one>_TO_<other> is where two objects touch, as faces of the first. Where the two slide, each has its own
/// nodes there; the second's faces are the surface <other>_TO_<one>, and the two surfaces are a contact pair
/// with the name of the first, whose slave is the softer side. Faces that share a node, at the end of a slit,
/// are in neither surface. attach() adds the node sets that hold and move the object.
///
/// Throws std::runtime_error where the filling fails, a sliding pair does not touch, or a holder holds
/// nothing; Stopped where `progress` requests it.
RegionDeck region_deck(const Objects& objects, const Object& object, const Deck& step,
                       const voxel::Progress& progress = {});

}  // namespace octotomy::planner
