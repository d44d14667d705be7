// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom_suite.h"

#include <gtest/gtest.h>
#include <set>

#include "voxel/read_scene.h"

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
    resolved += one.bounded.agreement != Agreement::BelowResolution;
    for (const Certificate* certificate : {&one.bounded, &one.closed_form})
      EXPECT_NE(certificate->agreement, Agreement::Fail)
          << certificate->operation << ": "
          << (certificate->reasons.empty() ? "" : certificate->reasons.front());
  }
  EXPECT_EQ(samplings.size(), 9U);
  EXPECT_EQ(resolved, 18);
  for (const Convergence& found : suite.convergences)
    EXPECT_GE(found.order, found.least_order) << found.quantity;
}

TEST(PhantomSuite, StopsWhenAsked) {
  std::stop_source source;
  PhantomSuiteOptions options;
  options.stop = source.get_token();
  options.progress = [&](const std::string&, double) { source.request_stop(); };
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
