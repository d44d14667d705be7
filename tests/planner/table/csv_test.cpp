// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/table/csv.h"

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
      EXPECT_EQ(std::string(error.what()), "row 2: a byte 0: it is no text, or not UTF-8");
    }
  }
}

}  // namespace
}  // namespace octotomy::planner
