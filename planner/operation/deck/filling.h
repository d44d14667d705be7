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

/// The tetrahedra of an object, with their findings.
struct Filling {
  convert::Tetrahedra tetrahedra;
  std::size_t bodies = 0;
  bool fallback = false;  ///< the elements are an octree's
  std::vector<std::string> findings;
};

struct FillingOptions {
  std::vector<convert::Refinement> finer{};
  bool fallback = false;       ///< use the voxels' elements where no mesher succeeds
  voxel::Progress progress{};  ///< a mesher reports the used share of its time
};

/// Fills the parts of an object's mesh that have at least 1/100 of the largest part's volume: smaller
/// fragments left by a cut cannot be loaded and held as bodies. Before that, cavities smaller than a voxel
/// are filled and the surface is simplified within a third of a voxel. Omitted parts are a finding with their
/// volume; several bodies are a finding as well.
///
/// Where no mesher succeeds, or dihedral angles remain that are unfit for a solver
/// (convert::fit_dihedral_deg()), and the fallback is allowed, the fallback is used, with a finding on the
/// reason. Where it is not allowed, the failure is returned as a text, and unfit angles are a finding. Throws
/// Stopped.
std::variant<Filling, std::string> filling_of(const Object& object, const FillingOptions& options);

/// The lines on elements in a deck's header: angles, ratio of radius to edge, and volume; then a histogram of
/// the smallest dihedral angles.
std::vector<std::string> quality_notes(const convert::TetQuality& quality);
/// The quality of the elements as JSON.
nlohmann::ordered_json quality_json(const convert::TetQuality& quality);

}  // namespace octotomy::planner
