// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/nearest_name.h"

#include <gtest/gtest.h>
#include <vector>

namespace octotomy::planner {
namespace {

const std::vector<std::string> known{"translate_mm", "rotate", "object", "window", "do"};

TEST(NearestName, CountsASwapOfNeighboursAsOneEdit) {
  const std::vector<std::string> words{"bxya", "ab"};
  EXPECT_EQ(nearest_name("ba", words), "ab");
}

TEST(NearestName, IsDeafToCaseAndFindsAForgottenUnit) {
  EXPECT_EQ(nearest_name("Translate", known), "translate_mm");
  EXPECT_EQ(nearest_name("objct", known), "object");
  EXPECT_EQ(nearest_name("WINDOW", known), "window");
}

TEST(NearestName, PrefersTheSameBeginningAmongEquallyNear) {
  const std::vector<std::string> words{"do", "id", "low"};
  EXPECT_EQ(nearest_name("lo", words), "low");
}

TEST(NearestName, GivesNoneWhereTheNearestWouldMislead) {
  EXPECT_EQ(nearest_name("zebra", known), std::nullopt);
  EXPECT_EQ(nearest_name("", known), std::nullopt);
}

TEST(NearestName, GivesNoneThatIsLongerThanPeopleType) {
  for (const std::size_t letters : {std::size_t{99}, std::size_t{100}, std::size_t{1'000'000}}) {
    const std::vector<std::string> words{std::string(letters, 'a')};
    const auto expected = letters < 100 ? std::optional(words[0]) : std::nullopt;
    EXPECT_EQ(nearest_name(words[0] + "b", words), expected) << letters;
  }
}

TEST(NearestName, GivesOneOfTwiceTheLengthAndNoneThatIsLonger) {
  const std::vector<std::string> twice{"abcd"}, longer{"abcde"};
  EXPECT_EQ(nearest_name("ab", twice), "abcd");
  EXPECT_EQ(nearest_name("ab", longer), std::nullopt);
}

TEST(NearestName, SuggestsAndListsWhatThereIs) {
  EXPECT_EQ(suggestion("objekt", known),
            ", did you mean 'object'? Known are translate_mm, rotate, object, window, do");
  EXPECT_EQ(suggestion("zebra", known), ": known are translate_mm, rotate, object, window, do");
  EXPECT_EQ(suggestion("zebra", {}), ": there are none to choose from");
}

}  // namespace
}  // namespace octotomy::planner
