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

/// The tetrahedra that fill an object, with findings on how they were made.
struct Filling {
  convert::Tetrahedra tetrahedra;
  std::size_t bodies = 0;
  bool fallback = false;  ///< the elements are the object's voxels
  std::vector<std::string> findings;
};

struct FillingOptions {
  std::vector<convert::Refinement> finer{};
  bool fallback = false;       ///< if no mesher succeeds, fill the object with its voxels
  voxel::Progress progress{};  ///< a mesher reports the share of its time limit that it has used
};

/// Fills an object's mesh with tetrahedra. Parts below 1/100 of the largest part's volume are left out first,
/// because such fragments of a cut cannot be loaded and held as bodies. Then cavities smaller than a voxel
/// are filled, and the surface is simplified within a third of a voxel. Findings state the volume of omitted
/// parts, and the number of bodies if there are several.
///
/// A filling fails if no mesher succeeds, or if dihedral angles are unfit for a solver
/// (convert::fit_dihedral_deg()). If the fallback is allowed, the object's voxels then become the elements,
/// with a finding on the reason. Otherwise the meshers' failure is returned as a text, and unfit angles are a
/// finding. Throws Stopped.
std::variant<Filling, std::string> filling_of(const Object& object, const FillingOptions& options);

/// Lines for a deck's header: range of dihedral angles, largest ratio of circumradius to shortest edge, and
/// volume; then a histogram of the elements' smallest dihedral angles.
std::vector<std::string> quality_notes(const convert::TetQuality& quality);
/// The quality of the elements as JSON.
nlohmann::ordered_json quality_json(const convert::TetQuality& quality);

}  // namespace octotomy::planner
