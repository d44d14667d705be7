// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Elements of every mesher and of both orders, solved by CalculiX, against closed forms.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <sstream>

#include "convert/deck/deck.h"
#include "convert/deck/second_order.h"
#include "convert/tet/region_tetrahedra.h"
#include "convert/tet/separate_regions.h"
#include "convert/tet/tetrahedralise.h"
#include "tests/convert/surfaces.h"
#include "tests/file_bytes.h"
#include "tests/run_command.h"
#include "tests/unit_universe.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/solid/combine.h"

namespace octotomy::convert {
namespace {

/// The total reaction of a set in a solved deck's .dat, in N.
glm::dvec3 reaction_n(const tests::ScratchFolder& folder, const Tetrahedra& t, const DeckOptions& options,
                      const std::string& set) {
  write_deck(t, folder / "job.inp", options);
  const tests::CommandAnswer ccx =
      tests::run_command("cd " + tests::quoted(folder / "") + " && ccx -i job", folder / "");
  EXPECT_EQ(ccx.status, 0) << ccx.out;
  const std::string dat = tests::bytes_of(folder / "job.dat");
  const std::size_t at = dat.find("total force (fx,fy,fz) for set " + set);
  if (at == std::string::npos)
    throw std::runtime_error("no total force of " + set + ": " + dat.substr(0, 500));
  std::istringstream line(dat.substr(dat.find('\n', at)));
  glm::dvec3 force(0.0);
  line >> force.x >> force.y >> force.z;
  return force;
}

NodeSet nodes_at(const Tetrahedra& t, const std::string& name, double z_mm) {
  constexpr double rounding_mm = 1e-3;
  NodeSet set{name, {}};
  for (const std::uint32_t v : t.boundary_nodes)
    if (std::abs(t.nodes_mm[v].z - z_mm) < rounding_mm) set.nodes.push_back(v);
  return set;
}

std::vector<glm::dvec3> all_by(const NodeSet& set, const glm::dvec3& by_mm) {
  return std::vector<glm::dvec3>(set.nodes.size(), by_mm);
}

/// A beam of square section. Both ends are held against turning, and one is moved across.
class Beam : public testing::TestWithParam<std::tuple<Mesher, bool>> {};

TEST_P(Beam, IsAsStiffAsTimoshenkoSays) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const auto [mesher, second] = GetParam();
  constexpr double side_mm = 10.0, length_mm = 60.0, by_mm = 0.1, modulus_mpa = 17000.0, poisson = 0.3;
  TetOptions fine;
  fine.mesher = mesher;
  fine.max_volume_mm3 = 4.0;
  const Tetrahedra t =
      tetrahedralise(brep::mesh_of(tests::box({0, 0, 0}, {side_mm, side_mm, length_mm})), fine);
  DeckOptions options;
  options.second_order = second;
  options.node_sets = {nodes_at(t, "LOW", 0.0), nodes_at(t, "HIGH", length_mm)};
  ASSERT_GT(options.node_sets[0].nodes.size(), 12U);
  ASSERT_GT(options.node_sets[1].nodes.size(), 12U);
  options.prescribed = {{"LOW", {}}, {"HIGH", all_by(options.node_sets[1], {0.0, by_mm, 0.0})}};
  const tests::ScratchFolder folder;
  const double found_n = reaction_n(folder, t, options, "HIGH").y;
  const double shear_mpa = modulus_mpa / 2.0 / (1.0 + poisson), area_mm2 = side_mm * side_mm,
               inertia_mm4 = std::pow(side_mm, 4) / 12.0;
  const double shape = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
  const double truth_n = by_mm / (std::pow(length_mm, 3) / (12.0 * modulus_mpa * inertia_mm4) +
                                  length_mm / (shape * shear_mpa * area_mm2));
  RecordProperty("share", std::to_string(found_n / truth_n));
  // Held ends cannot thin out, which stiffens the beam by some per cent; four-node elements lock in bending.
  // Mesh_3 still cuts some corners of the section off.
  EXPECT_GT(found_n, (mesher == Mesher::Mesh3 ? 0.95 : 0.99) * truth_n);
  EXPECT_LT(found_n, (second ? 1.05 : 1.25) * truth_n);
}

INSTANTIATE_TEST_SUITE_P(DeckElements, Beam,
                         testing::Combine(testing::Values(Mesher::TetGen, Mesher::Mesh3, Mesher::Stuffing),
                                          testing::Bool()));

/// A ball cut in two. Its halves touch without friction; one is pressed on the other and moved along the cut.
TEST(DeckElements, HalvesInContactSlideAlongAFlatCutWithoutForce) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const glm::dvec3 middle_mm(15.5);
  const voxel::Universe universe = tests::unit_universe(5);
  const voxel::Expression ball(voxel::Sphere{middle_mm, 9.0});
  const voxel::Expression below(voxel::HalfSpace{{0, 0, 1}, middle_mm.z});
  RegionMeshOptions size;
  size.size_mm = 3.0;
  const Tetrahedra shared =
      smooth_tetrahedra_of({voxel::combine(universe, ball & below), voxel::combine(universe, ball)}, size);
  for (const std::string& finding : shared.findings)
    EXPECT_EQ(finding.find("stay off its plane"), std::string::npos) << finding;
  DeckOptions options;
  for (Interface& between : interfaces(shared)) {
    options.surfaces.push_back({"LOW_TO_HIGH", std::move(between.faces)});
    options.surfaces.push_back({"HIGH_TO_LOW", std::move(between.opposite)});
    options.contacts.push_back({"CUT", "LOW_TO_HIGH", "HIGH_TO_LOW"});
  }
  ASSERT_EQ(options.contacts.size(), 1U);
  const Tetrahedra t = separate_regions(shared);
  options.node_sets = {{"LOW", {}}, {"HIGH", {}}};
  for (const std::uint32_t v : t.boundary_nodes) {
    const double away_mm = t.nodes_mm[v].z - middle_mm.z;
    if (away_mm < -4.0) options.node_sets[0].nodes.push_back(v);
    if (away_mm > 4.0) options.node_sets[1].nodes.push_back(v);
  }
  options.prescribed = {{"LOW", {}}, {"HIGH", all_by(options.node_sets[1], {0.2, 0.0, -0.01})}};
  const tests::ScratchFolder folder;
  const glm::dvec3 force_n = reaction_n(folder, t, options, "HIGH");
  EXPECT_LT(force_n.z, -100.0) << "pressed";
  // The rest of the force is from the ball's halves, whose cut faces no longer cover each other completely.
  EXPECT_LT(std::abs(force_n.x), 0.03 * std::abs(force_n.z));
}

/// Two blocks, one on the other, with corners at the rim of the cut between them.
TEST(DeckElements, BlocksInContactSlideWithoutForceWhateverTheSizeOfElements) {
  OCTOTOMY_NEEDS_PROGRAM("ccx", "calculix-ccx");
  const voxel::Universe universe = tests::unit_universe(5);
  const std::vector<voxel::Octree> blocks{
      voxel::combine(universe, voxel::Box{{3.5, 3.5, 3.5}, {27.5, 19.5, 11.5}}),
      voxel::combine(universe, voxel::Box{{3.5, 3.5, 11.5}, {27.5, 19.5, 19.5}})};
  for (const double size_mm : {1.5, 2.0, 3.0}) {
    RegionMeshOptions size;
    size.size_mm = size_mm;
    const Tetrahedra shared = smooth_tetrahedra_of(blocks, size);
    EXPECT_GE(quality(shared).min_dihedral_deg, 5.0);
    DeckOptions options;
    const Interface between = interfaces(shared).front();
    options.surfaces = {{"LOW_TO_HIGH", between.faces}, {"HIGH_TO_LOW", between.opposite}};
    options.contacts = {{"CUT", "LOW_TO_HIGH", "HIGH_TO_LOW"}};
    const Tetrahedra t = separate_regions(shared);
    options.node_sets = {nodes_at(t, "LOW", 3.5), nodes_at(t, "HIGH", 19.5)};
    options.prescribed = {{"LOW", {}}, {"HIGH", all_by(options.node_sets[1], {0.05, 0.0, -0.01})}};
    const tests::ScratchFolder folder;
    const glm::dvec3 force_n = reaction_n(folder, t, options, "HIGH");
    EXPECT_LT(force_n.z, -1000.0) << size_mm << " mm: pressed";
    EXPECT_LT(std::abs(force_n.x), 1e-4 * std::abs(force_n.z)) << size_mm << " mm";
    EXPECT_LT(std::abs(force_n.y), 1e-4 * std::abs(force_n.z)) << size_mm << " mm";
  }
}

}  // namespace
}  // namespace octotomy::convert
