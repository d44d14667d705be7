// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "convert/tetrahedralise.h"
#include "planner/evaluate.h"

namespace octotomy::planner {

/// What an export step wrote, or why it wrote nothing. Moving it may throw, as moving its JSON may.
struct Exported {  // NOLINT(bugprone-exception-escape)
  std::string id;
  std::string object;
  std::string path;  ///< within the result folder
  bool written = false;
  std::string content;  ///< for people: "12 345 tetrahedra, smallest dihedral 6.1 degrees"
  nlohmann::ordered_json details;
  std::vector<std::string> findings;
};

/// The tetrahedra of an object, and what is to be said of them.
struct Filling {
  convert::Tetrahedra tetrahedra;
  std::size_t bodies = 0;
  bool fallback = false;  ///< the elements are an octree's
  std::vector<std::string> findings;
};
/// What the exports of one result share.
struct Fillings {
  /// Objects that were filled already, by their names, whether the fallback was allowed and where elements
  /// are finer: several decks of one object are one filling.
  std::map<std::string, Filling> made{};
  std::stop_token stop{};  ///< ends a filling
};

/// Writes an object into a folder as the step's extension says: its mesh; tetrahedra that fill its mesh; its
/// voxels as a label map of the universe. Times are added to "tetrahedralise" and "write".
///
/// Tetrahedra fill the mesh's parts down to a hundredth of the largest: the crumbs that a cut leaves are no
/// bodies to load and hold. Cavities smaller than a voxel are filled and the surface is simplified before,
/// within a third of a voxel. What is left out is a finding with its volume, and so are several bodies in one
/// deck.
///
/// Where the step names further regions, or objects that hold and move this one, the deck is region_deck()'s
/// (region_deck.h).
///
/// An object that is empty, has no mesh, or that no mesher can fill is not written; a finding says why. Where
/// the step allows the fallback, its voxels' tetrahedra are written instead, marked by `fallback` in the
/// details and by a finding; and so they are where the meshers leave dihedral angles that are not fit for a
/// solver (convert::fit_dihedral_deg()), which else is a finding.
/// Throws what the writers throw where the disk does not take it, and Stopped where the stop token was set.
Exported export_object(const Evaluation& evaluation, const std::string& id, const ExportStep& step,
                       const std::filesystem::path& folder, Fillings& fillings, Timings& timings);

}  // namespace octotomy::planner
