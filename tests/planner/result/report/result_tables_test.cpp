// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/result_tables.h"

#include <gtest/gtest.h>

#include "planner/operation/table/json.h"

namespace octotomy::planner {
namespace {

TEST(ResultTables, ValuesAtAnyDepthAreColumnsAndWhatARowLacksIsEmpty) {
  const Json rows = Json::parse(R"([
    {"id": "a, b", "volume_mm3": 0.1, "mesh": {"volume_mm3": 2}, "centroid_mm": [1, 2.5, -3]},
    {"id": "c", "mesh": null, "held": true, "findings": ["left out"]}])");
  EXPECT_EQ(csv_of(rows),
            "id,volume_mm3,mesh.volume_mm3,centroid_mm.x,centroid_mm.y,centroid_mm.z,held\n"
            "\"a, b\",0.1,2,1,2.5,-3,\n"
            "c,,,,,,true\n");
}

TEST(ResultTables, EachMeasurementStatesTheGravestAuditOfTheScans) {
  const auto table = [](const std::string& scans) {
    return result_tables(
               Json::parse(R"({"measurements": [{"id": "size", "volume_mm3": 2}], "cephalometry": null,
      "certificates": [], "movements": [], "scans": )" +
                           scans + "}"))
        .at(0)
        .second;
  };
  const std::string pass = R"({"check": "size", "verdict": "PASS", "detail": ""})";
  const std::string warn = R"({"check": "unit", "verdict": "WARN", "detail": "a"})";
  const std::string fail = R"({"check": "slices", "verdict": "FAIL", "detail": "b"})";
  EXPECT_EQ(table("[]"), "id,volume_mm3\nsize,2\n");
  EXPECT_EQ(table("[{\"audit\": [" + pass + "]}]"), "id,volume_mm3,scan_audit\nsize,2,PASS\n");
  EXPECT_EQ(table("[{\"audit\": [" + fail + "," + warn + "]}, {\"audit\": [" + pass + "]}]"),
            "id,volume_mm3,scan_audit\nsize,2,FAIL\n");
  EXPECT_EQ(table("[{\"audit\": [" + pass + "]}, {\"audit\": [" + warn + "]}]"),
            "id,volume_mm3,scan_audit\nsize,2,WARN\n");
}

TEST(ResultTables, AMovementHasARowForItsPieceAndForEachLandmark) {
  const Json result = Json::parse(R"({"measurements": [], "cephalometry": null, "certificates": [],
    "movements": [{"object": "m", "from": "s", "pitch_deg": 3, "yaw_deg": 0, "roll_deg": 0, "words": "w",
      "centroid": {"forward_mm": 6, "left_mm": 0, "up_mm": 1, "words": "f"},
      "landmarks": [{"name": "ans", "forward_mm": 5, "left_mm": 0, "up_mm": 2, "words": "g",
                     "to_mm": [1, 2, 3]}]}]})");
  const auto tables = result_tables(result);
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0].first, "tables/movements.csv");
  EXPECT_EQ(tables[0].second,
            "object,point,forward_mm,left_mm,up_mm,words,pitch_deg,yaw_deg,roll_deg,to_mm.x,to_mm.y,to_mm.z\n"
            "m,centroid,6,0,1,f,3,0,0,,,\n"
            "m,ans,5,0,2,g,,,,1,2,3\n");
}

}  // namespace
}  // namespace octotomy::planner
