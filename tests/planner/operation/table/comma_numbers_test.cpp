// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/comma_numbers.h"

#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

using Numbers = std::vector<double>;

TEST(CommaNumbers, ReadsAsManyAsThereAre) {
  EXPECT_EQ(comma_numbers("0,-6,2.5"), (Numbers{0, -6, 2.5}));
  EXPECT_EQ(comma_numbers("1e3"), Numbers{1000});
  EXPECT_EQ(comma_numbers("1, 2"), (Numbers{1, 2}));
}

TEST(CommaNumbers, AreNoneWhereAnythingElseIsAmongThem) {
  for (const char* text :
       {"", ",", "1,", ",1", "1,,2", "1;2", "1,2 ", "1,two", "1mm", "nan", "0,inf,0", "1e999"})
    EXPECT_EQ(comma_numbers(text), Numbers{}) << "'" << text << "'";
}

TEST(CommaNumbers, ANumberIsTheWholeText) {
  EXPECT_EQ(number_in("-2.5"), -2.5);
  for (const char* text : {"", "1,2", "1 mm", "nan"}) EXPECT_EQ(number_in(text), std::nullopt) << text;
}

}  // namespace
}  // namespace octotomy::planner
