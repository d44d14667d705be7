// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/file/svg_outlines.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <tuple>

#include "tests/planner/ball_scan.h"
#include "voxel/solid/polygon.h"

namespace octotomy::planner {
namespace {

constexpr double tolerance_mm = 0.02;

class SvgOutlinesFile : public testing::Test {
 protected:
  /// One unit is one millimetre, y stays down.
  SvgOutlines read(const std::string& inside, const std::string& root = R"(width="100mm" height="100mm"
      viewBox="0 0 100 100")") {
    std::ofstream(folder_ / "a.svg") << "<?xml version=\"1.0\"?>\n<!DOCTYPE svg [<!ENTITY a \"b\">]>\n"
                                     << "<!-- <rect> --><svg " << root << ">" << inside << "</svg>\n";
    return read_svg_outlines(
        folder_ / "a.svg",
        [&](double mm_per_unit, const std::optional<SvgPicture>& picture) {
          picture_ = picture;
          return glm::dmat3({mm_per_unit, 0, 0}, {0, mm_per_unit, 0}, {0, 0, 1});
        },
        tolerance_mm);
  }
  std::vector<glm::dvec2> outline(const std::string& inside) {
    const SvgOutlines found = read(inside);
    EXPECT_EQ(found.polygons_mm.size(), 1u) << inside;
    return found.polygons_mm.front();
  }
  std::string refusal(const std::string& inside, const std::string& root = R"(viewBox="0 0 10 10")") {
    try {
      read(inside, root);
    } catch (const std::runtime_error& error) {
      const std::string said = error.what();
      EXPECT_EQ(said.find('\n'), std::string::npos);
      return said.substr(said.find("a.svg"));
    }
    return "";
  }

  tests::ScratchFolder folder_;
  std::optional<SvgPicture> picture_;
};

using Polygon = std::vector<glm::dvec2>;

TEST_F(SvgOutlinesFile, ShapesOfOneSquareAreTheSame) {
  const Polygon square{{10, 20}, {30, 20}, {30, 40}, {10, 40}};
  for (const char* text :
       {R"(<path d="M10,20 H30 V40 H10 Z"/>)", R"(<path d="m10 20 20 0 0 20-20 0z"/>)",
        R"(<path d="M 10 20 h 20 v 20 L 10 40"/>)", R"(<polygon points="10,20 30,20 30,40 10,40"/>)",
        R"(<polyline points="10 20,30 20,30 40,10 40"/>)", R"(<rect x="10" y="20" width="20" height="20"/>)",
        R"a(<g transform="translate(10 20)"><g transform="scale(2)"><rect width="10" height="10"/></g></g>)a",
        R"a(<rect width="20" height="20" transform="matrix(1 0 0 1 10 20)"/>)a",
        R"a(<rect x="20" y="-30" width="20" height="20" transform="rotate(90)"/>)a"}) {
    const Polygon found = outline(text);
    ASSERT_EQ(found.size(), 4u) << text;
    EXPECT_NEAR(std::abs(voxel::signed_area(found)), 400.0, 1e-9) << text;
    for (const glm::dvec2& corner : square)
      EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const glm::dvec2& p) {
        return glm::distance(p, corner) < 1e-9;
      })) << text;
  }
}

TEST_F(SvgOutlinesFile, CurvesStayWithinTheTolerance) {
  const auto off_circle_mm = [](const Polygon& polygon, const glm::dvec2& centre, double radius) {
    double most = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec2 middle = 0.5 * (polygon[i] + polygon[(i + 1) % polygon.size()]);
      most = std::max({most, std::abs(glm::distance(polygon[i], centre) - radius),
                       std::abs(glm::distance(middle, centre) - radius)});
    }
    return most;
  };
  const std::string half = "A 30 30 0 0 1 ";
  for (const std::string& text :
       {std::string(R"(<circle cx="50" cy="50" r="30"/>)"), std::string(R"(<ellipse cx="50" cy="50" rx="30"
        ry="30"/>)"),
        R"(<path d="M20 50 )" + half + "80 50 " + half + R"(20 50"/>)",
        std::string(R"(<path d="M20,50a30 30 0 1160,0a30,30 0 11-60 0"/>)"),
        std::string(R"(<rect x="20" y="20" width="60" height="60" rx="30"/>)"),
        // Large where it is seen, small in its own units.
        std::string(R"a(<circle cx=".5" cy=".5" r=".3" transform="scale(100)"/>)a")}) {
    const Polygon found = outline(text);
    EXPECT_LE(off_circle_mm(found, {50, 50}, 30.0), tolerance_mm) << text;
    EXPECT_LT(found.size(), 400u) << text;
    EXPECT_NEAR(std::abs(voxel::signed_area(found)), std::numbers::pi * 900.0, 2.5) << text;
  }
  // A quarter by a cubic is off the circle by 0.027 % of its radius.
  const double c = 30.0 * 0.5522847498;
  const std::string quarter = "M80 50C80 " + std::to_string(50 + c) + " " + std::to_string(50 + c) +
                              " 80 50 80 S 20 " + std::to_string(50 + c) + " 20 50 S " +
                              std::to_string(50 - c) + " 20 50 20 S 80 " + std::to_string(50 - c) + " 80 50";
  EXPECT_LE(off_circle_mm(outline("<path d=\"" + quarter + "\"/>"), {50, 50}, 30.0), tolerance_mm + 0.0085);
  // Under a parabola: two thirds of base and height. With its mirror image behind it nothing is left.
  EXPECT_NEAR(std::abs(voxel::signed_area(outline(R"(<path d="M20 50Q50 110 80 50Z"/>)"))),
              2.0 / 3.0 * 60.0 * 30.0, 2.0);
  EXPECT_NEAR(voxel::signed_area(outline(R"(<path d="M20 50Q50 110 80 50T140 50"/>)")), 0.0, 1e-6);
}

TEST_F(SvgOutlinesFile, HidesWhatIsNotDisplayedAndTellsWhatIsLeftOut) {
  const SvgOutlines found = read(R"(<defs><rect width="5" height="5"/></defs>
      <g style="fill:none; display: none"><rect width="5" height="5"/></g><rect display="none" width="5"
      height="5"/><text>cut</text><path d="M0 0L5 5"/><sodipodi:namedview a='1'><rect width="5" height="5"/>
      </sodipodi:namedview><rect width="7" height="7"/>)");
  ASSERT_EQ(found.polygons_mm.size(), 1u);
  EXPECT_NEAR(voxel::signed_area(found.polygons_mm[0]), 49.0, 1e-9);
  EXPECT_EQ(found.findings.size(), 2u);
}

TEST_F(SvgOutlinesFile, WhatAStyleHidesOrMovesIsLeftOutToldOrRefused) {
  const SvgOutlines found = read(R"(<rect visibility="hidden" width="5" height="5"/>
      <g style="visibility:hidden"><rect width="5" height="5"/></g><rect class="st0" width="7" height="7"/>)");
  ASSERT_EQ(found.polygons_mm.size(), 1u);
  EXPECT_NE(testing::PrintToString(found.findings).find("style sheet is not applied"), std::string::npos);
  EXPECT_THROW(read(R"svg(<rect style="transform:translate(5px,-3px)" width="5" height="5"/>)svg"),
               std::runtime_error);
}

TEST_F(SvgOutlinesFile, AClipPathOrMaskThatIsNotReadIsNamedWithItsElement) {
  const auto findings = [&](const std::string& inside) {
    const SvgOutlines found = read("<clipPath id=\"c\"><rect width=\"3\" height=\"3\"/></clipPath>" + inside);
    EXPECT_EQ(found.polygons_mm.size(), 1u) << inside;
    EXPECT_NEAR(std::abs(voxel::signed_area(found.polygons_mm[0])), 49.0, 1e-9) << inside;
    return found.findings;
  };
  const std::string size = "width=\"7\" height=\"7\"";
  for (const auto& [inside, cut] :
       {std::pair<std::string, const char*>{"<rect clip-path=\"url(#c)\" " + size + "/>",
                                            "clip-path of <rect>"},
        {"<g mask=\"url(#c)\"><g><rect " + size + "/></g></g>", "mask of <g>"},
        {"<g style=\"fill:none; clip-path : url(#c)\"><rect " + size + "/></g>", "clip-path of <g>"}}) {
    const std::vector<std::string> found = findings(inside);
    ASSERT_EQ(found.size(), 1u) << inside;
    EXPECT_EQ(found[0].find("WARN: the " + std::string(cut)), 0u) << found[0];
  }
  const std::string shape = "<rect " + size + "/>";
  for (const std::string& inside :
       {"<g clip-path=\"none\">" + shape + "</g>",
        "<g clip-path=\"url(#c)\" style=\"clip-path:none\">" + shape + "</g>",
        "<g clip-path=\"url(#c)\"><image href=\"a.png\" width=\"1\" height=\"1\"/></g>" + shape,
        "<g clip-path=\"url(#c)\"></g>" + shape})
    EXPECT_EQ(findings(inside).size(), 0u) << inside;
  EXPECT_EQ(read("<g clip-path=\"url(#c)\">" + shape + shape + "</g>").findings.size(), 1u) << "told once";
}

TEST_F(SvgOutlinesFile, UnitsAreTheRootsAndToldWhereTheyAreNone) {
  const auto side_mm = [&](const std::string& root, const std::string& side = "10") {
    const SvgOutlines found = read("<rect width=\"" + side + "\" height=\"" + side + "\"/>", root);
    return std::pair(std::sqrt(voxel::signed_area(found.polygons_mm[0])), found.findings.size());
  };
  EXPECT_NEAR(side_mm(R"(width="5cm" viewBox="0 0 100 50")").first, 5.0, 1e-9);
  EXPECT_NEAR(side_mm(R"(width="96" viewBox="0 0 96 96")").first, 254.0 / 96.0, 1e-9);
  EXPECT_NEAR(side_mm(R"(viewBox="0 0 100 50")").first, 254.0 / 96.0, 1e-9);
  EXPECT_EQ(side_mm(R"(viewBox="0 0 100 50")").second, 1u);
  EXPECT_EQ(side_mm(R"(width="5cm" viewBox="0 0 100 50")").second, 0u);
  EXPECT_NEAR(side_mm("width=\"100%\"", "20mm").first, 20.0, 1e-9);
}

TEST_F(SvgOutlinesFile, APixelIsThatOfTheProgramAndAFinding) {
  const auto read_by = [&](const std::string& before, const std::string& root) {
    std::ofstream(folder_ / "a.svg") << "<?xml version=\"1.0\"?>\n"
                                     << before << "<svg " << root
                                     << "><rect width=\"10\" height=\"10\"/></svg>\n";
    const SvgOutlines found = read_svg_outlines(
        folder_ / "a.svg",
        [](double mm_per_unit, const std::optional<SvgPicture>&) {
          return glm::dmat3({mm_per_unit, 0, 0}, {0, mm_per_unit, 0}, {0, 0, 1});
        },
        tolerance_mm);
    return std::pair(std::sqrt(voxel::signed_area(found.polygons_mm[0])),
                     found.findings.empty() ? std::string() : found.findings.front());
  };
  const std::string illustrator = "<!-- Generator: Adobe Illustrator 24.0.1, SVG Export Plug-In -->\n",
                    pixels = R"(width="200px" height="200px" viewBox="0 0 100 100")";
  for (const auto& [before, root, per_inch, program] :
       {std::tuple(illustrator, pixels, 72, "as Adobe Illustrator has it"),
        {illustrator, R"(width="200" viewBox="0 0 100 100")", 72, "as Adobe Illustrator has it"},
        {"", pixels, 96, "as CSS has it"},
        {"", R"(inkscape:version="0.48.4 r9939" )" + pixels, 90, "as Inkscape before 0.92 has it"},
        {"", R"(inkscape:version="0.92.3" )" + pixels, 96, "as Inkscape has it"},
        {"", R"(inkscape:version="1.2" )" + pixels, 96, "as Inkscape has it"}}) {
    const auto [side_mm, finding] = read_by(before, root);
    EXPECT_NEAR(side_mm, 20.0 * 25.4 / per_inch, 1e-9) << root;
    EXPECT_NE(finding.find("in pixels, whose length is assumed"), std::string::npos) << finding;
    EXPECT_NE(finding.find("1/" + std::to_string(per_inch) + " inch"), std::string::npos) << finding;
    EXPECT_NE(finding.find(program), std::string::npos) << finding;
  }
  const auto [side_mm, finding] = read_by(illustrator, R"(width="200mm" viewBox="0 0 100 100")");
  EXPECT_NEAR(side_mm, 20.0, 1e-9);
  EXPECT_EQ(finding, "");
}

TEST_F(SvgOutlinesFile, FindsThePictureAndWhereItStands) {
  read(R"a(<g transform="translate(5,5)"><image xlink:href="a%20b.png" x="1" y="2" width="40" height="30"/>
      </g><image href="c.png" width="1" height="1"/><rect width="7" height="7"/>)a");
  ASSERT_TRUE(picture_);
  EXPECT_EQ(picture_->link, "a%20b.png");
  EXPECT_EQ(glm::dvec2(picture_->user_from_shown[2]), glm::dvec2(6, 7));
  EXPECT_EQ(picture_->shown_units, glm::dvec2(40, 30));
}

TEST_F(SvgOutlinesFile, EntitiesAreNotExpandedAndNothingElseIsRead) {
  const auto with = [&](const std::string& declared, const std::string& inside) {
    std::ofstream(folder_ / "e.svg") << "<!DOCTYPE svg [" << declared << "]><svg width=\"10mm\" "
                                     << "viewBox=\"0 0 10 10\">" << inside
                                     << "<rect width=\"7\" height=\"7\"/></svg>";
    return read_svg_outlines(
        folder_ / "e.svg", [](double, const auto&) { return glm::dmat3(1.0); }, tolerance_mm);
  };
  // Ten levels of ten, which would be ten thousand million rectangles.
  std::string laughs = "<!ENTITY a0 \"<rect width='5' height='5'/>\">";
  for (int level = 1; level <= 10; ++level) {
    laughs += "<!ENTITY a" + std::to_string(level) + " \"";
    for (int i = 0; i < 10; ++i) laughs += "&a" + std::to_string(level - 1) + ";";
    laughs += "\">";
  }
  EXPECT_EQ(with(laughs, "&a10;").polygons_mm.size(), 1u);
  EXPECT_EQ(with(laughs, "<g id=\"&a10;\"/>").polygons_mm.size(), 1u);
  EXPECT_EQ(with("<!ENTITY w \"5\">", "").polygons_mm.size(), 1u);
  EXPECT_THROW(with("<!ENTITY w \"5\">", "<rect width=\"&w;\" height=\"5\"/>"), std::runtime_error);
  EXPECT_EQ(with("<!ENTITY f SYSTEM \"file:///etc/passwd\"><!ENTITY % p SYSTEM \"x.dtd\">%p;", "&f;")
                .polygons_mm.size(),
            1u);
}

TEST_F(SvgOutlinesFile, ElementsNestedTooDeepAreRefused) {
  const auto nested = [](int deep) {
    std::string begins, ends;
    for (int i = 0; i < deep; ++i) begins += "<g>", ends += "</g>";
    return begins + "<rect width=\"7\" height=\"7\"/>" + ends;
  };
  EXPECT_EQ(refusal(nested(900)), "");
  EXPECT_NE(refusal(nested(1100)).find("nested more than 1000 deep"), std::string::npos);
}

TEST_F(SvgOutlinesFile, RefusalsSayLineAndPlace) {
  EXPECT_EQ(refusal("\n<path d=\"M1 2 L3 x\"/>"),
            "a.svg, line 4: <path> d, character 9: a number is expected, not 'x'");
  EXPECT_NE(refusal("<path d=\"L3 3\"/>").find("begins with M"), std::string::npos);
  EXPECT_NE(refusal("<path d=\"M3 3 4\"/>").find("character 7: a number is expected"), std::string::npos);
  EXPECT_NE(refusal("<path d=\"M3 3 A 1 1 0 2 0 3 3\"/>").find("flag"), std::string::npos);
  EXPECT_NE(refusal("<path d=\"M3 3 B 1\"/>").find("commands"), std::string::npos);
  EXPECT_NE(refusal("<rect width=\"5em\" height=\"1\"/>").find("is not a length"), std::string::npos);
  EXPECT_NE(refusal("<rect transform=\"turn(3)\"/>").find("'turn' with 1 numbers"), std::string::npos);
  EXPECT_NE(refusal("<use/>").find("unlink clones"), std::string::npos);
  const std::string shape = "<rect width=\"5\" height=\"5\"/>";
  EXPECT_NE(refusal("<switch>" + shape + shape + "</switch>").find("delete all but one"), std::string::npos);
  EXPECT_EQ(refusal("<switch><foreignObject/><g>" + shape + shape + "</g></switch>"), "");
  EXPECT_NE(refusal("<g>").find("</svg> closes another element than the one that is open there"),
            std::string::npos);
  EXPECT_NE(refusal("<rect width=5/>").find("is not NAME=\"VALUE\""), std::string::npos);
  EXPECT_NE(refusal("<!-- ").find("is not closed by -->"), std::string::npos);
  EXPECT_NE(refusal("").find("has no outline"), std::string::npos);
  EXPECT_NE(
      refusal("<rect/>", "width=\"10mm\" height=\"30mm\" viewBox=\"0 0 10 10\"").find("differ from viewBox"),
      std::string::npos);
  std::ofstream(folder_ / "b.svg") << "<html></html>";
  EXPECT_THROW(read_svg_outlines(folder_ / "b.svg", {}, 0.1), std::runtime_error);
  std::ofstream(folder_ / "b.svg") << "\x89PNG not at all";
  EXPECT_THROW(read_svg_outlines(folder_ / "b.svg", {}, 0.1), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
