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
  for (const char* where : {"table 3.1, sphere", "figure 4.6", "table 5.1", "table 7.1", "section 3.2.3"})
    EXPECT_TRUE(places.contains(where)) << where;
}

TEST(ThesisTables, AnEntryThatDiffersByACharacterDoesNotAgree) {
  EXPECT_TRUE((ThesisEntry{"", "", "1160", "1160"}).agrees());
  EXPECT_FALSE((ThesisEntry{"", "", "1160", "1161"}).agrees());
}

TEST(ThesisTables, SayWhatIsNotRecomputedAndWhy) {
  for (const ThesisGap& gap : thesis_gaps()) EXPECT_FALSE(gap.why.empty()) << gap.where;
  EXPECT_FALSE(thesis_gaps().empty());
}

}  // namespace
}  // namespace octotomy::verify
