// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/slicer_markup.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

class SlicerMarkupFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& markups) const {
    std::ofstream(folder_ / "cut.mrk.json") << R"({"markups": [)" + markups + "]}";
    return folder_ / "cut.mrk.json";
  }
  MarkupPlane plane(const std::string& members) {
    findings_.clear();
    return read_plane(write(R"({"type": "Plane", )" + members + "}"), findings_);
  }
  std::string refusal(const std::string& members) {
    try {
      plane(members);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }
  tests::ScratchFolder folder_;
  std::vector<std::string> findings_;
};

const std::string lps = R"("coordinateSystem": "LPS", "coordinateUnits": "mm", )";
const std::string ras = R"("coordinateSystem": "RAS", "coordinateUnits": "mm", )";

void expect_plane(const MarkupPlane& plane, const glm::dvec3& origin_mm, const glm::dvec3& right,
                  const glm::dvec3& up) {
  EXPECT_LT(glm::distance(plane.origin_mm, origin_mm), 1e-12) << glm::distance(plane.origin_mm, origin_mm);
  EXPECT_LT(glm::distance(plane.right, right), 1e-12)
      << plane.right.x << " " << plane.right.y << " " << plane.right.z;
  EXPECT_LT(glm::distance(plane.up, up), 1e-12) << plane.up.x << " " << plane.up.y << " " << plane.up.z;
  EXPECT_LT(glm::distance(plane.normal, glm::cross(right, up)), 1e-12);
}

TEST_F(SlicerMarkupFile, APlaneLiesWhereItsFileStatesItInEitherFrame) {
  // As Slicer 5 writes a plane: right is forward, up is up.
  const std::string rest =
      R"("planeType": "pointNormal", "size": [40, 20, 0], "planeBounds": [-15, 25, -10, 10], )";
  const std::string in_lps = R"("center": [1, 2, 3], "orientation": [0, 0, -1, -1, 0, 0, 0, 1, 0],
      "controlPoints": [{"position": [1, 2, 3]}])";
  const std::string in_ras = R"("center": [-1, -2, 3], "orientation": [0, 0, 1, 1, 0, 0, 0, 1, 0],
      "controlPoints": [{"position": [-1, -2, 3]}])";
  for (const std::string& text : {lps + rest + in_lps, ras + rest + in_ras}) {
    const MarkupPlane found = plane(text);
    expect_plane(found, {1, 2, 3}, {0, -1, 0}, {0, 0, 1});
    EXPECT_EQ(*found.low_mm, glm::dvec2(-15, -10));
    EXPECT_EQ(*found.high_mm, glm::dvec2(25, 10));
    EXPECT_TRUE(findings_.empty()) << testing::PrintToString(findings_);
  }
}

TEST_F(SlicerMarkupFile, APlanesAxesComeFromItsBaseWhereNoOrientationIsStated) {
  const MarkupPlane found =
      plane(lps + R"("planeType": "pointNormal", "size": [8, 6], "controlPoints": [{"position": [1, 2, 3]}],
      "baseToNode": [0, 0, -1, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1])");
  expect_plane(found, {1, 2, 3}, {0, -1, 0}, {0, 0, 1});
  EXPECT_EQ(*found.high_mm, glm::dvec2(4, 3));
}

TEST_F(SlicerMarkupFile, APlaneOfThreePointsAloneIsAGuess) {
  const MarkupPlane found = plane(
      R"("controlPoints": [{"position": [1, 0, 0]}, {"position": [3, 0, 0]}, {"position": [4, 5, 0]}])");
  expect_plane(found, {1, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_FALSE(found.low_mm);
  ASSERT_EQ(findings_.size(), 3u);
  for (const std::string& finding : findings_)
    EXPECT_NE(finding.find("cut.mrk.json: WARN, "), std::string::npos) << finding;
}

TEST_F(SlicerMarkupFile, UnitsScalePlacesAndBoundsAndNoDirection) {
  const MarkupPlane found = plane(R"("coordinateSystem": "RAS", "coordinateUnits": "cm", "size": [2, 4],
      "center": [1, 0, 0], "orientation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "controlPoints": [])");
  expect_plane(found, {-10, 0, 0}, {-1, 0, 0}, {0, -1, 0});
  EXPECT_EQ(*found.high_mm, glm::dvec2(10, 20));
}

TEST_F(SlicerMarkupFile, RefusalsSayWhatAndWhere) {
  const std::string points = R"("controlPoints": [])";
  EXPECT_NE(refusal(lps + points).find("markups[0]: has neither 'center'"), std::string::npos)
      << refusal(lps + points);
  EXPECT_NE(refusal(lps + R"("center": [0, 0, 0], "orientation": [2, 0, 0, 0, 2, 0, 0, 0, 2], )" + points)
                .find("orientation: must be three perpendicular unit vectors"),
            std::string::npos);
  EXPECT_NE(refusal(lps + R"("center": [0, 0, 0], "orientation": [-1, 0, 0, 0, 1, 0, 0, 0, 1], )" + points)
                .find("right-handed"),
            std::string::npos);
  EXPECT_NE(refusal(lps + R"("center": [0, 0], "orientation": [1, 0, 0, 0, 1, 0, 0, 0, 1], )" + points)
                .find("center: must be a point"),
            std::string::npos);
  EXPECT_NE(
      refusal(
          R"("controlPoints": [{"position": [1, 0, 0]}, {"position": [2, 0, 0]}, {"position": [3, 0, 0]}])")
          .find("on one line"),
      std::string::npos);
  EXPECT_NE(refusal(lps + R"("controlPoints": [4])").find("controlPoints[0]: must be an object"),
            std::string::npos);
  const std::string one =
      R"({"type": "Plane", "center": [0, 0, 0], "orientation": [1, 0, 0, 0, 1, 0, 0, 0, 1], )" + points + "}";
  const auto two = write(one + "," + one);
  EXPECT_THROW(read_plane(two, findings_), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
