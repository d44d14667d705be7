// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/suite/representation_study.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

namespace octotomy::verify {
namespace {

TEST(RepresentationStudy, HoldsForAnyObjectWhatTheThesisFoundOfItsOwn) {
  const RepresentationStudy study = representation_study();
  std::set<std::string> places;
  for (const ThesisEntry& entry : study.entries) {
    EXPECT_EQ(entry.ours, entry.printed) << entry.where << ", " << entry.item;
    places.insert(entry.where);
  }
  for (const char* where : {"section 3.2.3", "figure 3.6", "theorem 3.1", "table 4.1", "table 4.2",
                            "table 5.2", "table 7.5", "table A.2", "table A.3", "figure 5.10"})
    EXPECT_TRUE(places.contains(where)) << where;

  // Rows to be read side by side have as many columns as the printed ones.
  places.clear();
  for (const ThesisComparison& row : study.beside) {
    places.insert(row.where);
    EXPECT_FALSE(row.ours.empty()) << row.where << ", " << row.item;
    if (row.where.rfind("table", 0) != 0 || row.where == "table 4.2") continue;
    if (row.printed == "not in the text at hand") {
      EXPECT_TRUE(row.where.ends_with("sphere")) << row.where;
      EXPECT_EQ(std::count(row.ours.begin(), row.ours.end(), ' '), 2) << row.where << ", " << row.item;
      continue;
    }
    EXPECT_EQ(std::count(row.ours.begin(), row.ours.end(), ' '),
              std::count(row.printed.begin(), row.printed.end(), ' '))
        << row.where << ", " << row.item << ": " << row.ours;
  }
  for (const char* where :
       {"table 3.1, skull", "table 3.1, chequered sphere", "table 3.2, 64 levels", "table 4.2", "table 7.5",
        "table A.1, skull", "table A.1, sphere", "table A.1, chequered sphere", "table A.2", "table A.3",
        "figure 5.8", "figure 5.9", "figure 5.10"})
    EXPECT_TRUE(places.contains(where)) << where;
}

}  // namespace
}  // namespace octotomy::verify
