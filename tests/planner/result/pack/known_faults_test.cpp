// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/known_faults.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

TEST(KnownFaults, AreThoseOfVersionsBeforeTheRepair) {
  EXPECT_TRUE(is_before("3.0.9", "3.0.24"));
  EXPECT_TRUE(is_before("3.0", "3.0.1"));
  EXPECT_FALSE(is_before("3.0.24", "3.0.24"));
  EXPECT_FALSE(is_before("10.0", "9.9.9"));
  const auto has = [](const char* version, const std::string& name) {
    const auto faults = faults_of({{"GDCM", version}});
    return std::any_of(faults.begin(), faults.end(), [&](const auto& fault) { return fault.name == name; });
  };
  EXPECT_TRUE(has("3.0.21", "CVE-2024-22373"));
  EXPECT_FALSE(has("3.0.24", "CVE-2024-22373"));
  EXPECT_TRUE(has("3.2.11", "CVE-2026-3650"));  // no release is without it
}

}  // namespace
}  // namespace octotomy::planner
