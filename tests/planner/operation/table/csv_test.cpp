// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/csv.h"

#include <gtest/gtest.h>

#include "voxel/space/error.h"

namespace octotomy::planner {
namespace {

TEST(Csv, AByte0IsRefusedWithItsRowWhereverItStands) {
  for (const std::string& row : {std::string("a\0b,c", 5), std::string("\"a\0b\",c", 7)}) {
    try {
      parse_csv("label,name\n" + row + "\n");
      ADD_FAILURE() << "was read";
    } catch (const voxel::Error& error) {
      EXPECT_EQ(std::string(error.what()),
                "row 2: a byte 0, so it is no text or not UTF-8: save it as UTF-8");
    }
  }
}

TEST(Tsv, CellsAreWhatTabsPartWhateverElseTheyHold) {
  EXPECT_EQ(parse_tsv("\xef\xbb\xbfindex\tname\r\n1\tLeft, upper\r\n\r\n2\t\"of \"\"two\"\t\n"),
            (std::vector<std::vector<std::string>>{
                {"index", "name"}, {"1", "Left, upper"}, {"2", "of \"\"two", ""}}));
  EXPECT_THROW(parse_tsv(std::string_view("a\0b", 3)), voxel::Error);
}

}  // namespace
}  // namespace octotomy::planner
