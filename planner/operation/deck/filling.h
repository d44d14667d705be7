// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "convert/tet/sizing_field.h"
#include "convert/tet/tetrahedra.h"
#include "planner/operation/table/object.h"
#include "voxel/space/progress.h"

namespace octotomy::planner {

/// The tetrahedra of an object, and what is to be said of them.
struct Filling {
  convert::Tetrahedra tetrahedra;
  std::size_t bodies = 0;
  bool fallback = false;  ///< the elements are an octree's
  std::vector<std::string> findings;
};

struct FillingOptions {
  std::vector<convert::Refinement> finer{};
  bool fallback = false;       ///< where no mesher succeeds, the voxels' own elements are taken
  voxel::Progress progress{};  ///< of the time that a mesher has
};

/// Fills the parts of an object's mesh down to a hundredth of the largest: the crumbs that a cut leaves are
/// no bodies to load and hold. Cavities smaller than a voxel are filled and the surface is simplified before,
/// within a third of a voxel. What is left out is a finding with its volume, and so are several bodies.
///
/// Where no mesher can fill it, or dihedral angles are left that are not fit for a solver
/// (convert::fit_dihedral_deg()), the fallback is taken where it is allowed, marked and with a finding that
/// says why; without it, the former is answered as a text for people, the latter a finding. Throws Stopped.
std::variant<Filling, std::string> filling_of(const Object& object, const FillingOptions& options);

/// What a deck's header says of its elements: angles, ratio of radius and edge, and volume; then how many
/// have which smallest dihedral angle.
std::vector<std::string> quality_notes(const convert::TetQuality& quality);
/// The same as JSON.
nlohmann::ordered_json quality_json(const convert::TetQuality& quality);

}  // namespace octotomy::planner
