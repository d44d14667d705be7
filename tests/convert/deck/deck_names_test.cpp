// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/deck_names.h"

#include <gtest/gtest.h>

#include "tests/convert/cube_in_five.h"
#include "tests/file_bytes.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::convert {
namespace {

/// Sets, surfaces, materials and contacts with names that solvers would confuse.
DeckOptions clashing() {
  DeckOptions options;
  options.materials = {{"BONE", 17000.0, 0.3}, {"bone", 1.0, 0.3}};
  options.material_of_tet = {0, 0, 0, 0, 1};
  options.node_sets = {{"Pin", {0}}, {"PIN", {1}}, {"surface", {2}}, {"NSOLID", {3}}};
  options.prescribed = {{"Pin", {}}, {"PIN", {{0, 0, 1}}}};
  options.surfaces = {{"SKIN", {{0, 0}}}, {"skin", {{1, 0}}}, {"Region1", {{2, 0}}}, {"EBONE", {{3, 0}}}};
  options.contacts = {{"SKIN", "SKIN", "skin"}, {"skin", "skin", "Region1"}};
  return options;
}

TEST(DeckNames, ThatDifferByCaseOrAreTheDecksOwnAreMadeUniqueWithWhatRefersToThem) {
  const Tetrahedra tetrahedra = tests::cube_in_five({0, 0, 0});
  DeckOptions options = clashing();
  ASSERT_TRUE(name_clash(tetrahedra, options));
  const std::vector<std::string> changed = make_names_unique(tetrahedra, options);
  EXPECT_EQ(changed.size(), 8U);
  EXPECT_FALSE(name_clash(tetrahedra, options));
  EXPECT_EQ(options.materials[1].name, "bone_2");
  EXPECT_EQ(options.node_sets[0].name, "Pin");
  EXPECT_EQ(options.node_sets[1].name, "PIN_2");
  EXPECT_EQ(options.node_sets[2].name, "surface_2");
  EXPECT_EQ(options.node_sets[3].name, "NSOLID_2");
  EXPECT_EQ(options.prescribed[0].node_set, "Pin");
  EXPECT_EQ(options.prescribed[1].node_set, "PIN_2");
  EXPECT_EQ(options.surfaces[1].name, "skin_2");
  EXPECT_EQ(options.surfaces[2].name, "Region1_2");
  // Ebone_2 is the element set of the second material.
  EXPECT_EQ(options.surfaces[3].name, "EBONE_3");
  EXPECT_EQ(options.contacts[0].slave, "SKIN");
  EXPECT_EQ(options.contacts[0].master, "skin_2");
  EXPECT_EQ(options.contacts[1].slave, "skin_2");
  EXPECT_EQ(options.contacts[1].master, "Region1_2");
  EXPECT_EQ(options.contacts[1].name, "skin_2");
  EXPECT_TRUE(make_names_unique(tetrahedra, options).empty());
}

TEST(DeckNames, ThatNoSolverTakesBeginWithALetterAndAreShortened) {
  const Tetrahedra tetrahedra = tests::cube_in_five({0, 0, 0});
  DeckOptions options;
  options.node_sets = {{"_a", {0}}, {std::string(90, 'b'), {1}}, {std::string(90, 'B'), {2}}};
  EXPECT_EQ(make_names_unique(tetrahedra, options).size(), 3U);
  EXPECT_EQ(options.node_sets[0].name, "X_a");
  for (const NodeSet& set : options.node_sets) EXPECT_TRUE(is_solver_name(set.name)) << set.name;
  EXPECT_FALSE(name_clash(tetrahedra, options));
}

TEST(DeckNames, AClashIsRefusedInEveryFormat) {
  const tests::ScratchFolder folder;
  const Tetrahedra tetrahedra = tests::cube_in_five({0, 0, 0});
  for (const char* name : {"a.inp", "a.feb", "a.vtu", "a.msh", "a.node"}) {
    EXPECT_THROW(write_deck(tetrahedra, folder / name, clashing()), std::invalid_argument) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / name));
  }
}

}  // namespace
}  // namespace octotomy::convert
