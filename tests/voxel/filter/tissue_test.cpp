// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/tissue.h"

#include <gtest/gtest.h>
#include <set>

namespace octotomy::voxel {
namespace {

double middle(std::string_view name) {
  const Tissue found = tissue(name).value();
  return 0.5 * (found.low.value_or(-1024) + found.high.value_or(3071));
}

TEST(Tissues, HaveNamesBoundsAndSources) {
  std::set<std::string_view> names;
  for (const Tissue& each : tissues()) {
    EXPECT_TRUE(names.insert(each.name).second) << each.name;
    EXPECT_TRUE(each.low || each.high) << each.name;
    EXPECT_LT(each.low.value_or(-1024), each.high.value_or(3071)) << each.name;
    EXPECT_GT(each.source.size(), 20U) << each.name;
  }
  for (const char* name :
       {"bone", "cortical_bone", "trabecular_bone", "teeth", "soft_tissue", "fat", "skin", "air"})
    EXPECT_TRUE(names.contains(name)) << name;
  EXPECT_FALSE(tissue("bones"));
  EXPECT_FALSE(tissue(""));
}

TEST(Tissues, StandInTheOrderOfTheirAttenuation) {
  const char* const order[] = {"air", "fat", "soft_tissue", "trabecular_bone", "cortical_bone", "teeth"};
  for (std::size_t i = 1; i < std::size(order); ++i)
    EXPECT_LT(middle(order[i - 1]), middle(order[i])) << order[i];
  // Air by definition is -1000, water 0, fat about -100, muscle about 50 HU.
  const auto holds = [](std::string_view name, double value) {
    const Tissue found = tissue(name).value();
    return value >= found.low.value_or(value) && value <= found.high.value_or(value);
  };
  EXPECT_TRUE(holds("air", -1000) && !holds("air", -100));
  EXPECT_TRUE(holds("fat", -100) && !holds("fat", 0));
  EXPECT_TRUE(holds("soft_tissue", 50) && !holds("soft_tissue", 300));
  EXPECT_TRUE(holds("skin", -100) && holds("skin", 2000) && !holds("skin", -1000));
}

}  // namespace
}  // namespace octotomy::voxel
