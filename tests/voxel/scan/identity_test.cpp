// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/identity.h"

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

TEST(Identity, WhatOneSideDoesNotStateIsUnstated) {
  const IdentityComparison found = compared({}, {"17", "", {"1.2.3"}, {"1.2.4"}});
  EXPECT_TRUE(found.differing.empty());
  EXPECT_EQ(found.unstated, (std::vector<std::string>{"patient", "study", "frame of reference"}));
}

}  // namespace
}  // namespace octotomy::voxel
