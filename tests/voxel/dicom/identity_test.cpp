// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/identity.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

TEST(Identity, FilesOfOnePatientStudyAndFrameAgree) {
  const Identity scan{"17", "Doe^Jane", {"1.2.3"}, {"1.2.4"}};
  const IdentityComparison same = compared(scan, {"17", "another spelling", {"9.9", "1.2.3"}, {"1.2.4"}});
  EXPECT_TRUE(same.differing.empty());
  EXPECT_TRUE(same.unstated.empty());
}

TEST(Identity, EachValueThatDiffersIsNamedWithBothSides) {
  const Identity scan{"17", "Doe^Jane", {"1.2.3"}, {"1.2.4"}};
  EXPECT_EQ(compared(scan, {"18", "", {"1.2.3"}, {"1.2.4"}}).differing,
            std::vector<std::string>{"patient '17' and '18'"});
  EXPECT_EQ(compared(scan, {"17", "", {"1.2.5"}, {"1.2.4"}}).differing,
            std::vector<std::string>{"study '1.2.3' and '1.2.5'"});
  EXPECT_EQ(compared(scan, {"17", "", {"1.2.3"}, {"1.2.6", "1.2.7"}}).differing,
            std::vector<std::string>{"frame of reference '1.2.4' and '1.2.6' or '1.2.7'"});
}

TEST(Identity, WithoutIdentifiersNamesAreComparedWithoutCaseAndEmptyComponents) {
  const Identity scan{"", "DOE^Jane^^^", {}, {}};
  EXPECT_TRUE(compared(scan, {"17", "Doe^JANE", {}, {}}).differing.empty());
  EXPECT_EQ(compared(scan, {"", "Roe^Jane", {}, {}}).differing.size(), 1U);
}

TEST(Identity, OneNumberOfTwoIssuersBirthDatesOrSexesIsOfTwoPatients) {
  const auto with = [](const char* issuer, const char* birth_date, const char* sex) {
    return Identity{"17", "", {"1.2.3"}, {"1.2.4"}, issuer, birth_date, sex};
  };
  const Identity scan = with("HOSP A", "19500101", "F");
  for (const Identity& same : {scan, with("", "", ""), with("hosp a", "19500101", "F")})
    EXPECT_TRUE(compared(scan, same).differing.empty());
  for (const Identity& other :
       {with("HOSP B", "19500101", "F"), with("HOSP A", "19600101", "F"), with("HOSP A", "19500101", "M")}) {
    ASSERT_EQ(compared(scan, other).differing.size(), 1U);
    EXPECT_TRUE(compared(scan, other).differing[0].starts_with("patient"));
  }
}

TEST(Identity, WhatOneSideDoesNotStateIsUnstated) {
  const IdentityComparison found = compared({}, {"17", "", {"1.2.3"}, {"1.2.4"}});
  EXPECT_TRUE(found.differing.empty());
  EXPECT_EQ(found.unstated, (std::vector<std::string>{"patient", "study", "frame of reference"}));
}

}  // namespace
}  // namespace octotomy::voxel
