// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/interval_suite.h"

#include <cmath>
#include <gtest/gtest.h>
#include <stdexcept>

namespace octotomy::verify {
namespace {

TEST(IntervalSuite, IntervalsHoldTheTruthAsOftenAsTheyClaimAndAreNotIdle) {
  constexpr int solids = 120;
  IntervalSuiteOptions options;
  options.solids = solids;
  options.seed = 5;
  int pooled = 0;
  for (const IntervalCoverage& row : interval_suite(options)) {
    if (!row.group.empty()) continue;
    ++pooled;
    EXPECT_EQ(row.cases, solids);
    // At most four of 120 may miss, which intervals of 99 % exceed once in a hundred runs.
    EXPECT_GE(std::lround(row.held * solids), solids - 4) << row.quantity;
    EXPECT_GE(row.p99_share, least_p99_share) << row.quantity;
  }
  EXPECT_EQ(pooled, 2);
}

TEST(IntervalSuite, RefusesToRunWithoutASolid) {
  IntervalSuiteOptions options;
  options.solids = 0;
  EXPECT_THROW(interval_suite(options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
