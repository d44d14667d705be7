// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/transfer.h"

#include <gtest/gtest.h>
#include <limits>

namespace octotomy::voxel {
namespace {

const TransferFunction transfer_ramp{{{-10.0, glm::vec3(0.0f), 0.0}, {10.0, glm::vec3(1.0f), 2.0}}, 50.0};

TEST(Transfer, IsLinearBetweenPointsAndConstantBeyondThem) {
  const TransferTable table(transfer_ramp, {-30, 30});
  EXPECT_FLOAT_EQ(table.at(0.0).per_mm, 1.0f);
  EXPECT_FLOAT_EQ(table.at(2.5).per_mm, 1.25f);
  EXPECT_FLOAT_EQ(table.at(2.5).light.x, 0.625f);
  EXPECT_FLOAT_EQ(table.at(-20.0).per_mm, 0.0f);
  EXPECT_FLOAT_EQ(table.at(30.0).per_mm, 2.0f);
}

TEST(Transfer, ARangeIsVisibleWhereAnyValueBetweenItsEndsIs) {
  // A peak between two samples that are themselves invisible.
  const TransferFunction peak{
      {{0.0, glm::vec3(1.0f), 0.0}, {5.0, glm::vec3(1.0f), 1.0}, {10.0, glm::vec3(1.0f), 0.0}}, 50.0};
  const TransferTable table(peak, {-100, 100});
  EXPECT_TRUE(table.visible({-50, 50}));
  EXPECT_TRUE(table.visible({0, 1}));
  EXPECT_TRUE(table.visible({9, 20}));
  EXPECT_TRUE(table.visible({5, 5}));
  EXPECT_FALSE(table.visible({-50, 0}));
  EXPECT_FALSE(table.visible({10, 90}));
  EXPECT_FALSE(table.visible({100, 100}));
  // The twin at the table's end.
  EXPECT_TRUE(TransferTable(transfer_ramp, {-30, 30}).visible({30, 30}));
}

TEST(Transfer, VisibleFromWhereExtinctionBeginsToRise) {
  EXPECT_EQ(visible_from(transfer_ramp), -10.0);
  EXPECT_EQ(visible_from({{{3.0, {}, 1.0}, {4.0, {}, 0.0}}, 50.0}), 3.0);
}

TEST(Transfer, PresetsAreSoundAndDifferAndOthersAreNamed) {
  ASSERT_EQ(preset_transfers().size(), 3u);
  for (const std::string& name : preset_transfers()) EXPECT_NO_THROW(check(preset_transfer(name))) << name;
  EXPECT_LT(visible_from(preset_transfer("skin")), -100.0);
  EXPECT_GT(visible_from(preset_transfer("bone")), 100.0);
  try {
    preset_transfer("hair");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("vessels"), std::string::npos);
  }
}

TEST(Transfer, ChecksRefuseWhatIsNoFunctionAndNameThePoint) {
  const auto refused = [](const TransferFunction& transfer, const char* word) {
    try {
      check(transfer);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what()).find(word) != std::string::npos;
    }
    return false;
  };
  EXPECT_TRUE(refused({{{0.0, {}, 1.0}}, 50.0}, "fewer"));
  EXPECT_TRUE(refused({{{0.0, {}, 1.0}, {0.0, {}, 1.0}}, 50.0}, "point 2"));
  EXPECT_TRUE(refused({{{0.0, {}, 1.0}, {1.0, {}, -1.0}}, 50.0}, "per_mm"));
  EXPECT_TRUE(refused({{{0.0, {}, 0.0}, {1.0, {}, 0.0}}, 50.0}, "nothing visible"));
  EXPECT_TRUE(refused({{{0.0, glm::vec3(2.0f), 1.0}, {1.0, {}, 0.0}}, 50.0}, "colour"));
  EXPECT_TRUE(refused({{{0.0, {}, 1.0}, {1.0, {}, 0.0}}, 0.0}, "surface_per_mm"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused({{{nan, {}, 1.0}, {1.0, {}, 0.0}}, 50.0}, "sample"));
  EXPECT_TRUE(refused({{{0.0, {}, nan}, {1.0, {}, 0.0}}, 50.0}, "per_mm"));
  EXPECT_NO_THROW(check(transfer_ramp));
  // Double precision holds these numbers; single precision, in which pictures are made, turns them into NaN.
  EXPECT_TRUE(refused({{{-1e308, {}, 0.0}, {1e308, {}, 1.0}}, 50.0}, "point 1"));
  EXPECT_TRUE(refused({{{0.0, {}, 0.0}, {1.0, {}, 1e308}}, 50.0}, "per_mm"));
}

}  // namespace
}  // namespace octotomy::voxel
