// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/phantom_suite.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "voxel/scan/read_scene.h"

namespace octotomy::verify {
namespace {

TEST(PhantomSuite, NoRightAnswerFailsAndEverySamplingIsThere) {
  PhantomSuiteOptions options;
  options.poses = 2;
  options.solid = "sphere";
  const PhantomSuite suite = phantom_suite(options);
  EXPECT_EQ(suite.cases.size(), 2U * 3U * 3U);
  std::set<std::string> samplings;
  int resolved = 0;
  for (const PhantomCase& one : suite.cases) {
    samplings.insert(one.sampling + one.spacing);
    resolved += one.bounded.resolved();
    for (const Certificate* certificate : {&one.bounded, &one.closed_form})
      EXPECT_NE(certificate->verdict, Verdict::Fail)
          << certificate->operation << ": "
          << (certificate->reasons.empty() ? "" : certificate->reasons.front());
  }
  EXPECT_EQ(samplings.size(), 9U);
  EXPECT_EQ(resolved, 18);
  for (const Convergence& found : suite.convergences)
    EXPECT_GE(found.order, found.least_order) << found.quantity;
}

TEST(PhantomSuite, PlatesOfOneVoxelAreNotResolvedAndNoneFails) {
  PhantomSuiteOptions options;
  options.poses = 2;
  options.solid = "plate, 1 voxel";
  const PhantomSuite suite = phantom_suite(options);
  EXPECT_EQ(suite.cases.size(), 2U * 3U * 3U);
  for (const PhantomCase& one : suite.cases)
    for (const Certificate* certificate : {&one.bounded, &one.closed_form}) {
      EXPECT_FALSE(certificate->resolved());
      EXPECT_NE(certificate->verdict, Verdict::Fail)
          << certificate->operation << ": "
          << (certificate->reasons.empty() ? "" : certificate->reasons.front());
    }
  // Nothing that is not resolved counts where tolerances are shown to be tight.
  for (const Tightness& tight : suite.tightness) EXPECT_EQ(tight.cases, 0);
}

/// A blurred box along the lattice has rounded flats, which err in step.
TEST(PhantomSuite, ScannedBoxesAlongTheLatticePassAndTheirPlacesAreJudgedByAWitness) {
  PhantomSuiteOptions options;
  options.poses = 3;
  options.solid = "box";
  int scanned = 0;
  for (const PhantomCase& one : phantom_suite(options).cases) {
    EXPECT_EQ(one.bounded.verdict, Verdict::Pass)
        << one.bounded.operation << ": " << (one.bounded.reasons.empty() ? "" : one.bounded.reasons.front());
    // The bound holds by itself, too.
    EXPECT_LE(std::abs(one.bounded.difference_mm3), one.bounded.tolerance_mm3) << one.bounded.operation;
    scanned += one.bounded.limit.has_value();
  }
  EXPECT_EQ(scanned, 3 * 3);
}

TEST(PhantomSuite, StopsWhenAsked) {
  std::stop_source source;
  PhantomSuiteOptions options;
  options.progress = {source.get_token(), [&](double) { source.request_stop(); }};
  EXPECT_THROW(phantom_suite(options), voxel::Stopped);
}

TEST(PhantomSuite, RefusesToRunWithoutPoses) {
  PhantomSuiteOptions options;
  options.poses = 0;
  EXPECT_THROW(phantom_suite(options), std::invalid_argument);
  options.poses = 1;
  options.solid = "teapot";
  EXPECT_THROW(phantom_suite(options), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::verify
