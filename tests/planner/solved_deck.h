// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>
#include <vector>

#include "convert/deck/calculix_result.h"
#include "planner/operation/deck/region_deck.h"
#include "tests/run_command.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::tests {

/// CalculiX's displacements of a deck's nodes. Precondition: ccx is installed.
inline std::vector<glm::dvec3> solved(const planner::RegionDeck& deck, const ScratchFolder& folder) {
  convert::write_deck(deck.tetrahedra, folder / "deck.inp", deck.options);
  const CommandAnswer ccx = run_command("cd " + quoted(folder / "") + " && ccx -i deck", folder / "");
  EXPECT_EQ(ccx.status, 0) << ccx.out;
  std::vector<glm::dvec3> displacements;
  for (const auto& each : convert::read_displacements(folder / "deck.frd", deck.tetrahedra.nodes_mm.size()))
    displacements.push_back(each.value());
  return displacements;
}

inline const convert::NodeSet& set_of(const planner::RegionDeck& deck, const std::string& name) {
  const auto& sets = deck.options.node_sets;
  const auto found =
      std::find_if(sets.begin(), sets.end(), [&](const convert::NodeSet& set) { return set.name == name; });
  if (found == sets.end()) throw std::out_of_range(name);
  return *found;
}

}  // namespace octotomy::tests
