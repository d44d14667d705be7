// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/fault.h"

#include <gtest/gtest.h>
#include <map>
#include <set>

#include "brep/mesh/triangles.h"
#include "convert/surface/cuberille.h"
#include "verify/certificate/certify_surface.h"
#include "verify/phantom/head_phantom.h"

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
