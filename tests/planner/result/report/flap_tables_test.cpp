// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/flap_tables.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"

namespace octotomy::planner {
namespace {

TEST(FlapTables, TellOrderLengthAngleAndContactAndEscapeNames) {
  const Json cut{{"at_mm", 20.0}, {"tilt_deg", 28.7}};
  const Json segment{{"number", 1},         {"object", "a<b"},    {"length_mm", 25.94},
                     {"shortest_mm", 17.4}, {"longest_mm", 34.5}, {"angle_to_last_deg", nullptr},
                     {"first_cut", cut},    {"second_cut", cut}};
  const Json contact{{"number", 1},
                     {"object", "contact_1"},
                     {"between", {"bone", "a<b"}},
                     {"contact_voxels_mm2", 177.0},
                     {"contact_mesh_mm2", nullptr},
                     {"tolerance_mm2", nullptr},
                     {"verdict", nullptr}};
  const Json flap{{"id", "flap"},
                  {"flap_segments", {segment}},
                  {"osteotomies", {contact}},
                  {"donor_used_mm", 130.57},
                  {"contact_estimator", "a volume over a thickness"}};
  const std::string html =
      flap_tables(measurements_of(Json::array({Json{{"id", "size"}, {"volume_mm3", 3.0}}, flap})));
  for (const char* part : {"1. a&lt;b", "25.9 mm", "20.0 mm, 28.7\u00b0", "177 mm\u00b2", "130.6 mm"})
    EXPECT_NE(html.find(part), std::string::npos) << part << " in " << html;
  EXPECT_EQ(html.find("a<b"), std::string::npos);
  EXPECT_EQ(flap_tables(measurements_of(Json::array({Json{{"id", "size"}, {"volume_mm3", 3.0}}}))), "");
}

}  // namespace
}  // namespace octotomy::planner
