// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/dicom/character_set.h"

#include <gtest/gtest.h>

namespace octotomy::voxel {
namespace {

// The texts are examples of DICOM PS3.5, annexes H to J.
TEST(CharacterSet, TextsOfTheStandardsExamplesBecomeUtf8) {
  EXPECT_EQ(utf8_of("ISO_IR 100", "Buc^J\xe9r\xf4me"), "Buc^J\u00e9r\u00f4me");
  EXPECT_EQ(utf8_of("ISO_IR 144", "\xbb\xde\xda"), "\u041b\u043e\u043a");
  EXPECT_EQ(utf8_of("\\ISO 2022 IR 87", "Yamada^Tarou=\x1b$B;3ED\x1b(B^\x1b$BB@O:\x1b(B"),
            "Yamada^Tarou=\u5c71\u7530^\u592a\u90ce");
  EXPECT_EQ(utf8_of("\\ISO 2022 IR 149", "Hong=\x1b$)C\xfb\xf3^\x1b$)C\xd1\xce\xd4\xd7"),
            "Hong=\u6d2a^\u5409\u6d1e");
  EXPECT_EQ(utf8_of("ISO_IR 192", "\xce\xb1"), "\u03b1");
}

TEST(CharacterSet, AsciiNeedsNoSetAndWhatDoesNotFitItsSetHasNoUtf8) {
  EXPECT_EQ(utf8_of("", "Ball"), "Ball");
  EXPECT_EQ(utf8_of("ISO_IR 999", "Ball"), "Ball");
  EXPECT_EQ(utf8_of("", "B\xe4ll"), std::nullopt);
  EXPECT_EQ(utf8_of("ISO_IR 999", "B\xe4ll"), std::nullopt);
  EXPECT_EQ(utf8_of("ISO_IR 192", "B\xe4ll"), std::nullopt);
}

}  // namespace
}  // namespace octotomy::voxel
