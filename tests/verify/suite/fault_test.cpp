// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/fault.h"

#include <gtest/gtest.h>
#include <map>
#include <set>

#include "brep/mesh/triangles.h"
#include "convert/surface/cuberille.h"
#include "verify/certificate/certify_surface.h"

namespace octotomy::verify {
namespace {

std::string told(const FaultTrial& trial) {
  std::string text = trial.fault + " in " + trial.kernel + ", " + trial.subject + ": " +
                     to_string(trial.certificate.verdict);
  for (const std::string& reason : trial.certificate.reasons) text += "; " + reason;
  return text;
}

/// Two subjects and the exact tier at one small size.
class SmallFaults : public testing::Test {
 protected:
  static const std::vector<FaultTrial>& trials() {
    static const std::vector<FaultTrial> all = [] {
      FaultOptions options;
      options.sizes = {32};
      return try_faults(options);
    }();
    return all;
  }
};

TEST_F(SmallFaults, LeaveTheirCleanTwinsAlone) {
  int clean = 0;
  for (const FaultTrial& trial : trials())
    if (trial.fault.empty()) {
      ++clean;
      EXPECT_EQ(trial.certificate.verdict, Verdict::Pass) << told(trial);
    }
  EXPECT_EQ(clean, 3);
}

TEST_F(SmallFaults, OfTheLibraryAreAllTriedInTheKernelsThatCanHaveThem) {
  std::map<std::string, std::set<std::string>> kernels;
  for (const FaultTrial& trial : trials()) kernels[trial.fault].insert(trial.kernel);
  for (const Fault& fault : faults()) EXPECT_FALSE(kernels[fault.name].empty()) << fault.name;
  for (const char* both : {"mirrored axis", "swapped operands", "off-by-one slice spacing", "stale result",
                           "rotation about the wrong point", "window edge off by 1/4"})
    EXPECT_EQ(kernels[both].size(), 2U) << both;
}

TEST_F(SmallFaults, OfConnectionAndOfMeaningAreCaughtBelowTheResolvedSizeToo) {
  for (const FaultTrial& trial : trials())
    for (const char* always : {"flipped normal", "flipped shell", "lost triangle", "duplicated shell",
                               "mirrored axis", "swapped operands", "stale result"})
      EXPECT_TRUE(trial.fault != always || trial.caught()) << told(trial);
}

TEST(DetectionPowerTable, CountsByFaultAndSizeAndHoldsOnlyWhereEverythingIsCaught) {
  FaultTrial clean, caught, missed;
  clean.voxels = caught.voxels = missed.voxels = resolved_size;
  caught.fault = missed.fault = "lost triangle";
  caught.must_be_caught = missed.must_be_caught = true;
  caught.certificate.verdict = Verdict::Fail;
  EXPECT_TRUE(detection_holds({clean, caught}));
  EXPECT_FALSE(detection_holds({clean, caught, missed}));
  EXPECT_FALSE(detection_holds({}));
  FaultTrial doubted = clean;
  doubted.certificate.verdict = Verdict::Warn;
  EXPECT_FALSE(detection_holds({doubted, caught}));
  missed.voxels = resolved_size / 2;
  EXPECT_TRUE(detection_holds({clean, caught, missed}));

  const auto table = detection_power({clean, caught, caught, missed});
  ASSERT_EQ(table.size(), 3U);
  EXPECT_EQ(table[0].fault, "clean");
  EXPECT_EQ(table[1].caught, 0);
  EXPECT_EQ(table[2].caught, 2);
}

TEST(CertifySurface, SaysWhatIsWrongWithTrianglesThatAreNoSolid) {
  voxel::Universe universe;
  universe.depth = 3;
  const voxel::Octree full = voxel::Octree::full(universe);
  const brep::Triangles cube = convert::triangles_of(convert::cuberille(full));
  BoundInputs inputs;
  EXPECT_EQ(certify_surface(full, cube, inputs).verdict, Verdict::Pass);
  brep::Triangles open = cube;
  open.faces.pop_back();
  const Certificate certificate = certify_surface(full, open, inputs);
  EXPECT_EQ(certificate.verdict, Verdict::Fail);
  EXPECT_EQ(certificate.voxel.volume_mm3, 512.0);
  ASSERT_FALSE(certificate.reasons.empty());
  EXPECT_NE(certificate.reasons.front().find("no solid"), std::string::npos);
  EXPECT_EQ(certify_surface(full, {}, inputs).verdict, Verdict::Fail);
}

}  // namespace

namespace {}  // namespace
}  // namespace octotomy::verify
