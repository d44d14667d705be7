// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/landmark_tables.h"

#include <gtest/gtest.h>

namespace octotomy::planner {
namespace {

TEST(LandmarkTables, TellGuessesWithTheirDoubtAndWhatWasNotFound) {
  const auto measurements = nlohmann::ordered_json::parse(R"([{"id": "airway", "distance_mm": 3},
    {"id": "guess", "landmarks": [{"name": "ans", "says": "the tip <of> the spine", "point_mm": [0.26, -87.7, -33.2],
      "uncertainty_mm": 1.04, "confirmed": false}],
     "missing": [{"name": "nasion", "says": "the root", "why": "there is no brow"}], "findings": ["a doubt"]}])");
  const std::string html = landmark_tables(measurements_of(measurements));
  for (const char* part : {"First guess of landmarks, guess", "ans", "the tip &lt;of&gt; the spine", "0.3",
                           "33.2", "1.0", "Nobody has confirmed them", "nasion: there is no brow", "a doubt"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  EXPECT_EQ(landmark_tables({}), "");
}

}  // namespace
}  // namespace octotomy::planner
