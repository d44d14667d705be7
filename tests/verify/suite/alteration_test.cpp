// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/alteration.h"

#include <gtest/gtest.h>
#include <set>

#include "verify/phantom/head_phantom.h"

namespace octotomy::verify {
namespace {

ScanToAlter head() {
  HeadOptions options;
  options.voxel_mm = 2.5;
  return {"head", std::make_shared<const voxel::Scene>(head_phantom(options)), 300.0};
}

TEST(Alterations, OfObjectsOfAScanOverTheLimitNeverPass) {
  AlterationOptions options;
  options.count = 60;
  options.voxels = 32;
  options.scans = {head()};
  options.objects_of_scan = 3;
  int over = 0;
  std::set<std::string> kinds;
  for (const Alteration& one : try_alterations(options)) {
    kinds.insert(one.kind);
    over += one.is_over_limit;
    EXPECT_FALSE(one.is_missed()) << one.kind << " in " << one.subject << ", " << one.altered_mm3 << " mm3";
    if (one.kind == unaltered) {
      EXPECT_EQ(one.verdict, one.clean_verdict);
    }
  }
  EXPECT_GT(over, 20);
  EXPECT_GE(kinds.size(), 10U);
}

TEST(Alterations, AreTheSameForASeedAndOthersForAnother) {
  AlterationOptions options;
  options.count = 6;
  options.voxels = 32;
  options.scans = {head()};
  options.objects_of_scan = 2;
  const std::vector<Alteration> first = try_alterations(options), again = try_alterations(options);
  options.seed = 2;
  const std::vector<Alteration> other = try_alterations(options);
  ASSERT_EQ(first.size(), again.size());
  bool differs = false;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].altered_mm3, again[i].altered_mm3);
    EXPECT_EQ(first[i].kind, again[i].kind);
    differs = differs || first[i].altered_mm3 != other[i].altered_mm3;
  }
  EXPECT_TRUE(differs);
}

TEST(Alterations, OfAScanWithoutAnObjectAreRefused) {
  ScanToAlter air = head();
  air.low = 1e6;
  AlterationOptions options;
  options.voxels = 32;
  options.scans = {air};
  EXPECT_THROW(try_alterations(options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
