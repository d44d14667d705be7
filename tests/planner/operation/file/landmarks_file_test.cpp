// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/landmarks_file.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

class LandmarksFile : public testing::Test {
 protected:
  std::vector<brep::Landmark> read(const std::string& text) const {
    std::ofstream(folder_ / "marks.json") << text;
    return read_landmarks(folder_ / "marks.json");
  }
  /// The message of the refusal.
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  tests::ScratchFolder folder_;
};

TEST_F(LandmarksFile, OwnLandmarksKeepTheirOrderAndWeights) {
  const auto marks = read(R"({"landmarks":[{"name":"nasion","point_mm":[1,-2,3.5],"weight":2},
                                           {"name":"sella","point_mm":[4,5,6]}]})");
  ASSERT_EQ(marks.size(), 2u);
  EXPECT_EQ(marks[0].name, "nasion");
  EXPECT_EQ(marks[0].p_mm, glm::dvec3(1, -2, 3.5));
  EXPECT_EQ(marks[0].weight, 2.0);
  EXPECT_EQ(marks[1].weight, 1.0);
}

TEST_F(LandmarksFile, AGuessIsRefusedUntilItIsConfirmed) {
  const std::string begin =
      R"({"landmarks":[{"name":"nasion","says":"the deepest point","point_mm":[1,-2,3.5],)"
      R"("uncertainty_mm":2.5,"confirmed":)";
  EXPECT_NE(refusal(begin + "false}]}").find("'nasion' is a guess that nobody has confirmed"),
            std::string::npos);
  const auto marks = read(begin + "true}]}");
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(marks[0].p_mm, glm::dvec3(1, -2, 3.5));
  EXPECT_NE(refusal(begin + "\"later\"}]}").find("'confirmed'"), std::string::npos);
}

TEST_F(LandmarksFile, SlicersMarkupsAreTurnedFromRasToLps) {
  const std::string points = R"("controlPoints":[{"label":"N","position":[1,2,3]},
                               {"label":"later","position":[0,0,0],"positionStatus":"undefined"}])";
  const auto lps = read(R"({"markups":[{"type":"Fiducial","coordinateSystem":"LPS",)" + points + "}]}");
  const auto ras = read(R"({"markups":[{"type":"Fiducial","coordinateSystem":"RAS",)" + points + "}]}");
  ASSERT_EQ(lps.size(), 1u);
  ASSERT_EQ(ras.size(), 1u);
  EXPECT_EQ(lps[0].p_mm, glm::dvec3(1, 2, 3));
  EXPECT_EQ(ras[0].p_mm, glm::dvec3(-1, -2, 3));
}

TEST_F(LandmarksFile, SlicersMarkupsStateTheirSystemAsANumberTooAndTheirUnit) {
  const auto place = [&](const std::string& facts) {
    return read(R"({"markups":[{)" + facts + R"("controlPoints":[{"label":"N","position":[1,2,3]}]}]})")
        .at(0)
        .p_mm;
  };
  EXPECT_EQ(place(""), glm::dvec3(1, 2, 3));
  EXPECT_EQ(place(R"("coordinateSystem":0,)"), glm::dvec3(-1, -2, 3));
  EXPECT_EQ(place(R"("coordinateSystem":"1",)"), glm::dvec3(1, 2, 3));
  EXPECT_EQ(place(R"("coordinateUnits":"cm",)"), glm::dvec3(10, 20, 30));
  EXPECT_EQ(place(R"("coordinateUnits":[["m","UCUM","meter"],["m","UCUM","meter"],["m","UCUM","meter"]],)"),
            glm::dvec3(1000, 2000, 3000));
  EXPECT_EQ(place(R"("coordinateUnits":["mm","UCUM","millimeter"],)"), glm::dvec3(1, 2, 3));
  EXPECT_EQ(place(R"("coordinateUnits":"millimeters",)"), glm::dvec3(1, 2, 3));
  EXPECT_EQ(place(R"("coordinateUnits":"[in_i]",)"), glm::dvec3(25.4, 2 * 25.4, 3 * 25.4));
  EXPECT_NE(refusal(R"({"markups":[{"coordinateUnits":"furlong","controlPoints":[]}]})").find("furlong"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"markups":[{"coordinateUnits":["mm","cm","mm"],"controlPoints":[]}]})")
                .find("different units"),
            std::string::npos);
}

TEST_F(LandmarksFile, SlicersLinesOfCommasAreTurnedToLps) {
  const auto marks = [&](const std::string& system, const std::string& more = "") {
    std::ofstream(folder_ / "marks.fcsv") << "# Markups fiducial file version = 4.11\r\n" + system + more +
                                                 "1,10.5,-20,30,0,0,0,1,1,1,0,nasion,the deepest,vtkMRML\r\n"
                                                 "2,1,2,3,0,0,0,1,1,1,0,\"sella, left\",,\r\n";
    return read_landmarks(folder_ / "marks.fcsv");
  };
  const std::string columns = "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\r\n";
  for (const char* ras : {"# CoordinateSystem = RAS\r\n", "# CoordinateSystem = 0\r\n", ""}) {
    const auto read = marks(ras, columns);
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].name, "nasion");
    EXPECT_EQ(read[0].p_mm, glm::dvec3(-10.5, 20, 30)) << ras;
    EXPECT_EQ(read[1].name, "sella, left");
  }
  for (const char* lps : {"# CoordinateSystem = LPS\n", "# CoordinateSystem = 1\n"})
    EXPECT_EQ(marks(lps)[0].p_mm, glm::dvec3(10.5, -20, 30)) << lps;
  EXPECT_THROW(marks("# CoordinateSystem = 2\n"), std::runtime_error) << "indices need their scan";
  EXPECT_THROW(marks("# CoordinateSystem = LPS\n# CoordinateSystem = RAS\n"), std::runtime_error);
  EXPECT_EQ(marks("# CoordinateSystem = LPS\n# CoordinateSystem = 1\n").size(), 2u);
  std::ofstream(folder_ / "old.fcsv") << "# name = F\n# columns = label,x,y,z,sel,vis\nA,1,2,3,1,1\n";
  EXPECT_EQ(read_landmarks(folder_ / "old.fcsv").at(0).p_mm, glm::dvec3(-1, -2, 3));
  // A mark of the byte order, before a comment and before the first point.
  std::ofstream(folder_ / "marked.fcsv")
      << "\xef\xbb\xbf# CoordinateSystem = LPS\n1,1,2,3,0,0,0,1,1,1,0,A,,\n";
  EXPECT_EQ(read_landmarks(folder_ / "marked.fcsv").at(0).p_mm, glm::dvec3(1, 2, 3));
  std::ofstream(folder_ / "marked.fcsv") << "\xef\xbb\xbf"
                                            "1,1,2,3,0,0,0,1,1,1,0,A,,\n";
  EXPECT_EQ(read_landmarks(folder_ / "marked.fcsv").at(0).p_mm, glm::dvec3(-1, -2, 3));
  std::ofstream(folder_ / "bad.fcsv") << "1,x,2,3,0,0,0,1,1,1,0,A,,\n";
  EXPECT_THROW(read_landmarks(folder_ / "bad.fcsv"), std::runtime_error);
}

TEST_F(LandmarksFile, EveryRefusalNamesWhatIsWrong) {
  EXPECT_NE(refusal("{").find("marks.json"), std::string::npos);
  EXPECT_NE(refusal(std::string(100'000, '[')).find("nested more than 512 deep"), std::string::npos);
  EXPECT_NE(refusal("{}").find("\"landmarks\""), std::string::npos);
  EXPECT_NE(refusal(R"({"landmarks":[],"markups":[]})").find("has both"), std::string::npos);
  EXPECT_NE(refusal(R"({"landmarks":[{"point_mm":[0,0,0]}]})").find("landmark 0 has no name"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"landmarks":[{"name":"A","point_mm":[0,0]}]})").find("'A'"), std::string::npos);
  EXPECT_NE(refusal(R"({"landmarks":[{"name":"A","point":[0,0,0]}]})").find("point_mm"), std::string::npos);
  EXPECT_NE(
      refusal(R"({"landmarks":[{"name":"A","point_mm":[0,0,0],"weight":"big"}]})").find("weight of 'A'"),
      std::string::npos);
  EXPECT_NE(refusal(R"({"markups":[{"coordinateSystem":"XYZ","controlPoints":[]}]})").find("XYZ"),
            std::string::npos);
  EXPECT_THROW(read_landmarks(folder_ / "absent.json"), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
