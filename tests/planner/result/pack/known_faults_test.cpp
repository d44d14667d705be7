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
  // A distribution's fourth number counts too.
  const auto of_pictures = [](const char* version) { return faults_of({{"OpenImageIO", version}}).size(); };
  EXPECT_GT(of_pictures("2.4.8.0"), of_pictures("2.4.8.1"));
}

TEST(KnownFaults, StateWhereTheyStandAndOnWhichDataTheyAreCalled) {
  nlohmann::ordered_json oldest;
  for (const char* library : {"Expat", "GDCM", "OpenImageIO", "OpenJPEG", "OpenSSL", "SQLite", "libcurl",
                              "libpng", "libtiff", "zlib"})
    oldest[library] = "0.1";
  for (const KnownFault& fault : faults_of(oldest)) {
    EXPECT_NE(fault.effect, "") << fault.name;
    EXPECT_EQ(fault.reason.empty(), fault.place == KnownFault::Place::InDecoder) << fault.name;
    EXPECT_TRUE(oldest.contains(fault.library) || fault.place == KnownFault::Place::NotLinked) << fault.name;
  }
  EXPECT_GT(faults_of(oldest).size(), 25U);
}

}  // namespace
}  // namespace octotomy::planner
