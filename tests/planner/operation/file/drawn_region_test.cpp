// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/drawn_region.h"

#include <fstream>
#include <gtest/gtest.h>

#include "planner/operation/file/picture_frame.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

using Polygon = std::vector<glm::dvec2>;

class DrawnRegionFile : public testing::Test {
 protected:
  DrawnRegionFile() {
    // Half a millimetre a pixel; the top left pixel's centre shows u -10, v 20 of the left view.
    const voxel::ImagePlane plane{
        voxel::parse_view("left"), {80, 60}, {-10.25 + 20, 20.25 - 15}, 0.5, 0.0, 0.0};
    voxel::write_image(picture(), {80, 60}, std::vector<std::uint8_t>(14400, 99),
                       image_text(frame_of(plane)));
  }
  std::filesystem::path picture() const { return folder_ / "left.png"; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  static std::string base64(const std::string& bytes) {
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
      std::uint32_t bits = 0;
      for (std::size_t k = 0; k < 3; ++k)
        bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
      for (int shift = 18; shift >= 0; shift -= 6) text += digits[bits >> shift & 63];
      if (i % 60 == 57) text += '\n';
    }
    for (std::size_t i = 0; i < (3 - bytes.size() % 3) % 3; ++i) text[text.size() - 1 - i] = '=';
    return text;
  }
  template <typename Read>
  static std::string refusal(Read&& read) {
    try {
      read();
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
  static void expect_polygon(const DrawnRegion& drawn, const std::string& view, const Polygon& expected) {
    EXPECT_EQ(drawn.view, view);
    ASSERT_EQ(drawn.region.polygons_mm.size(), 1u);
    ASSERT_EQ(drawn.region.polygons_mm[0].size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_LT(glm::distance(drawn.region.polygons_mm[0][i], expected[i]), 1e-4)
          << i << ": " << drawn.region.polygons_mm[0][i].x << ", " << drawn.region.polygons_mm[0][i].y;
  }

  tests::ScratchFolder folder_;
};

TEST_F(DrawnRegionFile, PixelsOfAPictureAreMillimetresOfItsView) {
  expect_polygon(region_of_pixels(picture().string() + ":0,0 20,0 20,10.5"), "left",
                 {{-10, 20}, {0, 20}, {0, 14.75}});
  EXPECT_EQ(
      region_of_pixels(picture().string() + ":0,0 20,0 20,10; 30,30 40,30 40,40").region.polygons_mm.size(),
      2u);
}

TEST_F(DrawnRegionFile, ADrawingOverAPictureLiesWhereThePictureDoes) {
  // Pixels' corners: pixel (20, 10) lies from 20 to 21, its corner shows u -0.25, v 15.25.
  const Polygon expected{{-10.25, 20.25}, {-0.25, 20.25}, {-0.25, 15.25}};
  const std::string outline = R"(<path d="M0 0 20 0 20 10"/></g></svg>)";
  const std::string begin = R"a(<svg><g transform="rotate(30) translate(3,4) scale(.1,.2)">)a";
  const auto drawn = [&](const std::string& image, const std::string& then) {
    return read_drawn_region(write("a.svg", begin + image + then));
  };
  expect_polygon(drawn(R"(<image href="left.png" width="80" height="60"/>)", outline), "left", expected);
  // Fitted into a box that is too wide: in its middle, as high as the box.
  expect_polygon(drawn(R"(<image href="left.png" x="-10" width="100" height="60"/>)", outline), "left",
                 expected);
  expect_polygon(drawn(R"(<image preserveAspectRatio="none" href="left.png" width="160" height="60"/>)",
                       R"(<path d="M0 0 40 0 40 10"/></g></svg>)"),
                 "left", expected);
  expect_polygon(drawn(R"(<image xlink:href="data:image/png;base64,)" + base64(tests::bytes_of(picture())) +
                           R"(" width="80" height="60"/>)",
                       outline),
                 "left", expected);
}

TEST_F(DrawnRegionFile, ADrawingInAViewIsInMillimetresWithYUp) {
  const std::string file =
      write("a.svg", R"(<svg width="10cm" viewBox="-50 -50 100 100"><path d="M-20 10H30V-5Z"/></svg>)");
  expect_polygon(read_drawn_region("anterior:" + file), "anterior", {{-20, -10}, {30, -10}, {30, 5}});
}

TEST_F(DrawnRegionFile, OutlinesThatTheEvenOddRuleReadsOtherwiseAreTold) {
  const auto findings = [&](const std::string& shapes) {
    const std::string file =
        write("a.svg", R"(<svg width="10cm" viewBox="-50 -50 100 100">)" + shapes + "</svg>");
    return testing::PrintToString(read_drawn_region("anterior:" + file).findings);
  };
  const std::string one = R"(<rect x="-10" y="-10" width="20" height="20"/>)";
  EXPECT_EQ(findings(one), "{}");
  EXPECT_NE(findings(one + R"(<rect x="0" y="-5" width="20" height="10"/>)").find("2 polygons cross"),
            std::string::npos);
  EXPECT_NE(findings(one + one).find("drawn twice"), std::string::npos);
  EXPECT_NE(findings(one + R"(<rect x="-5" y="-5" width="5" height="5"/>)").find("1 outline lies within"),
            std::string::npos);
}

TEST_F(DrawnRegionFile, ClosedCurvesOfSlicerAreProjected) {
  const auto curve = [](const std::string& system, const std::string& points) {
    return R"({"@schema": "markups-schema-v1.0.3.json#",
      "markups": [{"type": "Fiducial", "controlPoints": []},
      {"type": "ClosedCurve", "coordinateSystem": ")" +
           system + R"(", "coordinateUnits": "mm", "controlPoints": [)" + points + "]}]}";
  };
  const auto point = [](const std::string& p) { return R"({"id": "1", "position": [)" + p + "]}"; };
  const std::string lps = point("1,2,3") + "," + point("11,2,3") + "," + point("11,5,13") + "," +
                          R"({"position": [0, 0, 0], "positionStatus": "undefined"})";
  const std::string ras = point("-1,-2,3") + "," + point("-11,-2,3") + "," + point("-11,-5,13");
  for (const std::string& text : {curve("LPS", lps), curve("RAS", ras)}) {
    const DrawnRegion drawn = read_drawn_region("anterior:" + write("cut.mrk.json", text));
    expect_polygon(drawn, "anterior", {{1, 3}, {11, 3}, {11, 13}});
    EXPECT_EQ(drawn.findings.size(), 2u);  // the list of points, and the spline's bend
  }
  const DrawnRegion unstated = read_drawn_region(
      "anterior:" +
      write("old.mrk.json", R"({"markups": [{"type": "ClosedCurve", "controlPoints": [)" + lps + "]}]}"));
  expect_polygon(unstated, "anterior", {{1, 3}, {11, 3}, {11, 13}});
  const std::string assumed = testing::PrintToString(unstated.findings);
  EXPECT_NE(assumed.find("WARN, frame: the file names no coordinateSystem"), std::string::npos) << assumed;
  EXPECT_NE(assumed.find("WARN, unit: the file names no coordinateUnits"), std::string::npos) << assumed;
  const auto said = [&](const std::string& text) {
    return refusal([&] { read_drawn_region("left:" + write("bad.mrk.json", text)); });
  };
  EXPECT_NE(said(curve("IJK", lps)).find("markups[1]: the coordinate system 'IJK' is unknown"),
            std::string::npos);
  EXPECT_NE(said(curve("LPS", point("1,2,3"))).find("markups[1]: has 1 placed points"), std::string::npos);
  EXPECT_NE(said(curve("LPS", point("1,2"))).find("controlPoints[0].position: must be a point"),
            std::string::npos);
  EXPECT_NE(said(R"({"markups": []})").find("no markup of type ClosedCurve"), std::string::npos);
  EXPECT_NE(said(R"({"markups": [{"type": 3}]})").find("bad.mrk.json"), std::string::npos);
  EXPECT_NE(said(R"({"markups": [{"type": "ClosedCurve", "controlPoints": 3, "coordinateSystem": 4}]})")
                .find("bad.mrk.json"),
            std::string::npos);
  EXPECT_NE(said(R"({"markups": [3]})").find("bad.mrk.json"), std::string::npos);
}

TEST_F(DrawnRegionFile, RefusalsSayWhatAndWhere) {
  const auto pixels = [&](const std::string& text) { return refusal([&] { region_of_pixels(text); }); };
  EXPECT_NE(pixels(picture().string() + ":0,0 20,0 90,10").find("'90,10' lies outside of"),
            std::string::npos);
  EXPECT_NE(pixels(picture().string() + ":0,0 20,0 x").find("'x' is no pixel X,Y"), std::string::npos);
  EXPECT_NE(pixels(picture().string() + ":0,0 20,0").find("--region-pixels: "), std::string::npos);
  EXPECT_NE(pixels("none.png:0,0 1,0 1,1").find("no such file"), std::string::npos);
  EXPECT_NE(pixels("0,0 1,0 1,1").find("write PICTURE.png"), std::string::npos);
  const auto file = [&](const std::string& text) { return refusal([&] { read_drawn_region(text); }); };
  EXPECT_NE(file("cut.json").find("write VIEW:FILE"), std::string::npos);
  EXPECT_NE(file("front:cut.svgz").find("save it as plain .svg"), std::string::npos);
  EXPECT_NE(file("cut.svgz").find("save it as plain .svg"), std::string::npos);
  EXPECT_NE(file("front:cut.json").find("no view 'front'"), std::string::npos);
  const std::string rectangle = R"(<rect width="5" height="5"/></svg>)";
  EXPECT_NE(file(write("a.svg", "<svg>" + rectangle)).find("anterior:a.svg"), std::string::npos);
  EXPECT_NE(
      file(write("a.svg", R"(<svg><image href="x.png" width="1" height="1"/>)" + rectangle)).find("x.png"),
      std::string::npos);
  EXPECT_NE(file(write("a.svg", R"(<svg><image href="x.jpg" width="1" height="1"/>)" + rectangle))
                .find("is not a .png"),
            std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
