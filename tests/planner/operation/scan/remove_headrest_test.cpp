// SPDX-License-Identifier: AGPL-3.0-or-later
// Heads on boards, couches, cradles, holders and foam, with the truth of every sample.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/planner/operation/scan/supported_head.h"
#include "tests/reference_data.h"
#include "voxel/filter/headrest.h"
#include "voxel/filter/patient.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::tests {
namespace {

RemovalTally removed_from(const SupportedHead& head) {
  const voxel::PatientParts parts = voxel::patient_parts(head.scene);
  return tally(head, [&](std::size_t i) { return parts.of[i] == voxel::Belongs::Support; });
}

void expect_parted(const SupportOptions& options) {
  const SupportedHead head = head_on_supports(options);
  const RemovalTally tally = removed_from(head);
  ASSERT_GT(tally.support_l, 0.2);
  EXPECT_LT(tally.left_l, 0.05 * tally.support_l);
  EXPECT_LE(tally.foam_left_l, 0.08 * tally.foam_l) << "the layer at the skin is not told from its blur";
  EXPECT_EQ(tally.bone_mm3, 0.0);
  EXPECT_LT(tally.soft_share, 0.001);
  EXPECT_EQ(tally.front_mm3, 0.0);
}

SupportOptions on(SupportOptions::Table table) {
  SupportOptions options;
  options.table = table;
  options.voxel_mm = glm::dvec3(2.5);
  options.blur_mm = 0.8;
  options.noise_hu = 30.0;
  return options;
}

TEST(RemoveHeadrest, TakesTheCouchWithItsFoamAndNothingOfTheHead) {
  expect_parted(on(SupportOptions::Table::Couch));
}

TEST(RemoveHeadrest, TakesABoardThatTheHeadIsPressedInto) {
  SupportOptions options = on(SupportOptions::Table::Board);
  options.sink_mm = 2.0;
  options.head_turn_deg = {15, 5, -20};
  expect_parted(options);
}

TEST(RemoveHeadrest, TakesAnInclinedCradleWithAHolderThatEndsWithinTheScan) {
  SupportOptions options = on(SupportOptions::Table::Cradle);
  options.holder = true;
  options.table_tilt_deg = 4.0;
  expect_parted(options);
}

TEST(RemoveHeadrest, LeavesTheMarkerBeforeTheNoseAndTakesThePillow) {
  SupportOptions options = on(SupportOptions::Table::Couch);
  options.marker = options.pillow = true;
  options.noise_hu = 50.0;
  options.voxel_mm = {2.0, 2.0, 3.0};
  expect_parted(options);
}

TEST(RemoveHeadrest, TakesAnInclinedCradleWithFoamThatTheHeadLiesIn) {
  SupportOptions options = on(SupportOptions::Table::Cradle);
  options.pillow = true;
  options.table_tilt_deg = -5.0;
  options.noise_hu = 55.0;
  options.head_turn_deg = {0, 0, 12};
  options.voxel_mm = glm::dvec3(2.0);
  expect_parted(options);
}

TEST(RemoveHeadrest, TakesAThickSolidCouchAndAStrapAndLeavesAnArmOnIt) {
  SupportOptions options = on(SupportOptions::Table::Slab);
  options.strap = true;
  options.arm_mm = 30.0;
  expect_parted(options);
}

TEST(RemoveHeadrest, OfRandomHeadsTakesTheSupportAndNothingOfThePatient) {
  int tables = 0, arms = 0;
  for (std::uint64_t seed = 100; seed < 106; ++seed) {
    SCOPED_TRACE(::testing::Message() << "random_supports(" << seed << ")");
    SupportOptions options = random_supports(seed);
    options.voxel_mm = glm::max(options.voxel_mm, glm::dvec3(2.0));
    tables += options.table != SupportOptions::Table::None;
    arms += options.arm_mm > 0.0;
    const RemovalTally tally = removed_from(head_on_supports(options));
    EXPECT_LE(tally.left_l, 0.05 * tally.support_l);
    EXPECT_EQ(tally.bone_mm3, 0.0);
    EXPECT_LT(tally.soft_share, 0.001);
    EXPECT_EQ(tally.front_mm3, 0.0);
  }
  EXPECT_GT(tables, 2);
  EXPECT_GT(arms, 0);
}

TEST(RemoveHeadrest, TakesLessThanOneInTenThousandOfAHeadWithoutASupport) {
  const SupportedHead head = head_on_supports(on(SupportOptions::Table::None));
  const RemovalTally tally = removed_from(head);
  EXPECT_EQ(tally.bone_mm3, 0.0);
  EXPECT_EQ(tally.front_mm3, 0.0);
  EXPECT_LT(tally.soft_share, 1e-4);
}

TEST(RemoveHeadrest, TheTallySeesWhatIsLeftAndWhatIsCut) {
  const SupportedHead head = head_on_supports(on(SupportOptions::Table::Board));
  const RemovalTally none = tally(head, [](std::size_t) { return false; });
  EXPECT_EQ(none.left_l, none.support_l);
  const RemovalTally all = tally(head, [](std::size_t) { return true; });
  EXPECT_GT(all.bone_mm3, 1e5);
  EXPECT_EQ(all.soft_share, 1.0);
  EXPECT_GT(all.front_mm3, 1e6);
}

TEST(RemoveHeadrest, IsTheSameOnOneThread) {
  const SupportedHead head = head_on_supports(on(SupportOptions::Table::Couch));
  const auto parts = voxel::patient_parts(head.scene).of;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(parts, voxel::patient_parts(head.scene).of);
}

TEST(RemoveHeadrest, OfRealHeadsTakesTheHolderAndNoBoneInFront) {
  for (const std::string name : {"ct_unc_cthead.nrrd", "ct_invesalius_cranium.nii.gz"}) {
    SCOPED_TRACE(name);
    OCTOTOMY_NEEDS_DATA(name);
    const voxel::Scene scan = voxel::read_scene(reference_data(name));
    const voxel::HeadrestRemoval removal = voxel::remove_headrest(scan);
    EXPECT_GT(removal.solid_mm3, 50000.0);
    EXPECT_LT(removal.solid_mm3, 110000.0);
    EXPECT_LT(removal.bone_mm3, 60000.0) << "the shell of a head holder";
    const auto& before = std::get<voxel::Int16Samples>(scan.samples);
    const auto& after = std::get<voxel::Int16Samples>(removal.scene.samples);
    const glm::ivec3 dims = scan.lattice.dims;
    std::size_t i = 0;
    for (int z = 0; z < dims.z; ++z)
      for (int y = 0; y < dims.y; ++y)
        for (int x = 0; x < dims.x; ++x, ++i)
          if (before[i] != after[i]) {
            ASSERT_GE(scan.lattice.lps_mm({x, y, z}).y, removal.middle_y_mm);
          }
  }
}

}  // namespace
}  // namespace octotomy::tests
