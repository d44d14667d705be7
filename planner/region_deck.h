// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "convert/deck.h"
#include "planner/evaluate.h"
#include "voxel/progress.h"

namespace octotomy::planner {

/// Several objects as regions of one deck.
struct RegionDeck {
  convert::Tetrahedra tetrahedra;
  convert::DeckOptions options;  ///< materials, surfaces and contacts of the regions
  bool fallback = false;         ///< the elements are the voxels', where smooth ones were asked for
  std::vector<std::string> findings;
};

/// Fills an object and the step's regions: by their voxels' elements, or by smooth ones of the size that the
/// step asks for (convert::smooth_tetrahedra_of()), and by the former, marked, where that fails and the step
/// allows the fallback. Each has the step's material for it, or cortical bone's, which is a finding. Surfaces
/// are FREE_<object> where nothing touches it and <one>_TO_<other> where they touch, as the first's faces.
/// Where the step wants contact, regions have nodes of their own there, the other's faces are the surface
/// <other>_TO_<one>, and the two are a contact pair of the first's name, the softer one its slave. Throws
/// std::runtime_error where there is no filling, Stopped where `progress` asks for it.
RegionDeck region_deck(const Evaluation& evaluation, const Object& object, const ExportStep& step,
                       const voxel::Progress& progress = {});

}  // namespace octotomy::planner
