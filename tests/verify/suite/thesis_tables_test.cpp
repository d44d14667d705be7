// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/thesis_tables.h"

#include <gtest/gtest.h>
#include <set>

namespace octotomy::verify {
namespace {

TEST(ThesisTables, AreWhatTheKernelsComputeEntryByEntry) {
  std::set<std::string> places;
  for (const ThesisEntry& entry : thesis_tables()) {
    EXPECT_EQ(entry.ours, entry.printed) << entry.where << ", " << entry.item;
    places.insert(entry.where);
  }
  for (const char* where : {"table 3.1, sphere", "figure 4.6", "table 4.3", "table 5.1", "table 7.1",
                            "section 3.2.3", "section 8.3"})
    EXPECT_TRUE(places.contains(where)) << where;
}

TEST(ThesisTables, AnEntryThatDiffersByACharacterDoesNotAgree) {
  EXPECT_TRUE((ThesisEntry{"", "", "1160", "1160"}).agrees());
  EXPECT_FALSE((ThesisEntry{"", "", "1160", "1161"}).agrees());
}

TEST(ThesisTables, LeaveOutNothingButTheSecondsOfTheMachinesOf1989) {
  ASSERT_EQ(thesis_gaps().size(), 1u);
  EXPECT_NE(thesis_gaps().front().where.find("seconds"), std::string::npos);
  EXPECT_NE(thesis_gaps().front().why.find("1989"), std::string::npos);
}

}  // namespace
}  // namespace octotomy::verify
