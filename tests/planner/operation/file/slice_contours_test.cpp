// SPDX-License-Identifier: AGPL-3.0-or-later
// Contours on slices and offsets as scripts see them.
#include "planner/operation/file/slice_contours.h"

#include <cmath>

#include "planner/operation/file/region_file.h"
#include "tests/planner/cli/program/command_line.h"
#include "tests/voxel/scratch_folder.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::CommandLine;
using tests::SortedJson;

/// The areas of the circles in a ball's slices 1 mm apart.
double circles_mm2(double radius_mm) {
  double sum = 0.0;
  for (double z = -15.5; z < 16.0; z += 1.0) sum += M_PI * std::max(0.0, radius_mm * radius_mm - z * z);
  return sum;
}

double sum_of(const SortedJson& json, const char* key) {
  double sum = 0.0;
  for (const SortedJson& slice : json["slices"]) sum += slice[key].get<double>();
  return sum;
}

TEST_F(CommandLine, ContoursOfABallAreItsCirclesAndMakeItsMask) {
  const CommandAnswer answer = run("contours " + at("ball.nrrd") + " --window 0: -o " + at("c.json") +
                                   " --codes " + at("f.json") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson json = SortedJson::parse(answer.out);
  EXPECT_EQ(json["contours"], 24);
  EXPECT_EQ(json["slices"].size(), 26u) << "an empty one at either end says where the ball ends";
  EXPECT_NEAR(sum_of(json, "area_mm2"), circles_mm2(12), 0.01 * circles_mm2(12));

  ASSERT_EQ(
      run("mask --slices " + at("c.json") + " --like " + at("ball.nrrd") + " -o " + at("c.octree")).status,
      0);
  const SortedJson mask = SortedJson::parse(run("measure " + at("c.octree") + " --json").out);
  EXPECT_NEAR(mask["volume_mm3"].get<double>(), tests::ball_mm3(12), 0.03 * tests::ball_mm3(12));
  EXPECT_NEAR(mask["centroid_mm"][2].get<double>(), 0.0, 0.05) << "not shifted along the slices";

  const SortedJson codes = SortedJson::parse(std::ifstream(folder_ / "f.json"));
  EXPECT_EQ(codes["slices"].size(), 26u);
  int stepped = 0;
  for (const SortedJson& slice : codes["slices"])
    for (const SortedJson& chain : slice["chains"]) {
      const auto steps = chain["steps"].get<std::string>();
      EXPECT_EQ(steps.find_first_not_of("01234567"), std::string::npos);
      stepped += steps.size() > 8;
    }
  EXPECT_GT(stepped, 20);
}

TEST_F(CommandLine, ContoursMoveOutThinAndLeaveSmallOnesOut) {
  ASSERT_EQ(run("contours " + at("ball.nrrd") + " --window 0: -o " + at("c.json")).status, 0);
  const auto asked = [&](const std::string& options) {
    const CommandAnswer answer =
        run("contours " + at("c.json") + " " + options + " -o " + at("d.json") + " --json");
    EXPECT_EQ(answer.status, 0) << answer.errors;
    return SortedJson::parse(answer.out);
  };
  const SortedJson all = asked("");
  const double area = sum_of(all, "area_mm2"), perimeter = sum_of(all, "perimeter_mm");
  // Steiner's formula for each of 24 convex contours.
  EXPECT_NEAR(sum_of(asked("--by 1.5"), "area_mm2"), area + 1.5 * perimeter + 24 * M_PI * 2.25, 0.002 * area);
  const SortedJson thinned = asked("--thin 0.1");
  EXPECT_LT(thinned["points"].get<int>(), all["points"].get<int>() / 2);
  EXPECT_NEAR(sum_of(thinned, "area_mm2"), area, 0.02 * area);
  EXPECT_EQ(asked("--least-area 150")["contours"], 20) << "four of the smallest go";
  EXPECT_NEAR(sum_of(asked("--harmonics 4"), "area_mm2"), area, 0.01 * area);
  expect_refused(run("contours " + at("c.json") + " --by -20 -o " + at("e.json")), "no contour remains");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "e.json"));
}

TEST_F(CommandLine, AContourThatSmoothingWouldCrossKeepsMoreOfItsShape) {
  // A comb of long teeth, which few harmonics fold, beside a square.
  std::string comb = "[[0,0]";
  for (int tooth = 0; tooth < 12; ++tooth) {
    const std::string x = std::to_string(tooth), half = std::to_string(tooth) + ".1",
                      next = std::to_string(tooth) + ".9";
    comb += ",[" + half + ",30],[" + x + ".2,30],[" + x + ".3,1],[" + next + ",1]";
  }
  comb += ",[12,0]]";
  write("c.json", R"({ "view": "inferior", "slices": [
      { "position_mm": 0, "polygons_mm": [ )" +
                      comb + R"(, [[20,0],[30,0],[30,10],[20,10]] ] },
      { "position_mm": 2, "polygons_mm": [ [[20,0],[30,0],[30,10],[20,10]] ] } ] })");
  const CommandAnswer answer =
      run("contours " + at("c.json") + " --harmonics 3 -o " + at("d.json") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson said = SortedJson::parse(answer.out);
  EXPECT_EQ(said["contours"], 3);
  ASSERT_EQ(said["findings"].size(), 1u) << said["findings"];
  EXPECT_NE(said["findings"][0].get<std::string>().find("the slice at 0"), std::string::npos)
      << said["findings"];
  EXPECT_NE(answer.errors.find("cross itself"), std::string::npos) << answer.errors;
}

TEST_F(CommandLine, ContoursAreEditedByHandAndRefusedWhereTheyCross) {
  write("c.json", R"({ "view": "inferior", "slices": [
      { "position_mm": 0, "polygons_mm": [ [[0,0],[10,0],[10,10],[0,10]], [[20,0],[30,0],[30,10],[20,10]] ] },
      { "position_mm": 2, "polygons_mm": [ [[0,0],[10,0],[10,10],[0,10]] ] } ] })");
  const auto edit = [&](const std::string& edits) {
    write("edits.json", R"({ "edits": [)" + edits + "] }");
    return run("contours " + at("c.json") + " --edits " + at("edits.json") + " -o " + at("d.json") +
               " --json");
  };
  const auto areas = [&](const std::string& edits) {
    const CommandAnswer answer = edit(edits);
    EXPECT_EQ(answer.status, 0) << answer.errors;
    const SortedJson json = SortedJson::parse(answer.out);
    return std::pair(json["slices"][0]["area_mm2"].get<double>(), json["contours"].get<int>());
  };
  using Pair = std::pair<double, int>;
  EXPECT_EQ(areas(R"({"slice":0,"contour":0,"do":"move","point":2,"to_mm":[10,20]})"), Pair(250, 3));
  EXPECT_EQ(areas(R"({"slice":0,"contour":0,"do":"insert","piece":1,"at_mm":[14,5]})"), Pair(220, 3));
  EXPECT_EQ(areas(R"({"slice":0,"contour":1,"do":"delete","point":0})"), Pair(150, 3));
  EXPECT_EQ(areas(R"({"slice":0,"contour":1,"do":"remove"})"), Pair(100, 2));
  EXPECT_EQ(areas(R"({"slice":0,"contour":0,"do":"split","first":0,"second":2})"), Pair(200, 4));
  // A gate from the right side of the first to the left side of the second.
  EXPECT_EQ(areas(R"({"slice":0,"contour":0,"do":"join","piece":1,"with":1,"its_piece":3})"), Pair(300, 2));
  EXPECT_EQ(areas(R"({"slice":0,"do":"add","points_mm":[[0,20],[4,20],[0,24]]})"), Pair(208, 4));
  // Numbers refer to the contours after the earlier edits.
  EXPECT_EQ(areas(R"({"slice":0,"contour":0,"do":"remove"},{"slice":0,"contour":0,"do":"delete","point":0})"),
            Pair(50, 2));

  // Each edit follows another edit of the same contour.
  const std::string moved = R"({"slice":0,"contour":0,"do":"move","point":2,"to_mm":[10,20]},)";
  EXPECT_EQ(areas(moved + R"({"slice":0,"contour":0,"do":"insert","piece":3,"at_mm":[-4,5]})"), Pair(270, 3));
  EXPECT_EQ(areas(moved + R"({"slice":0,"contour":0,"do":"delete","point":0})"), Pair(200, 3));
  EXPECT_EQ(areas(moved + R"({"slice":0,"contour":0,"do":"split","first":0,"second":2},
                             {"slice":0,"contour":2,"do":"move","point":1,"to_mm":[-10,10]})"),
            Pair(350, 4));

  write("c.json", R"({ "view": "inferior", "slices": [
      { "position_mm": 0, "polygons_mm": [ [[0,0],[10,0],[10,10],[0,10]], [[20,0],[30,0],[30,10],[20,10]],
                                           [[40,0],[50,0],[40,10],[50,10],[60,5]] ] },
      { "position_mm": 2, "polygons_mm": [ [[0,0],[10,0],[10,10],[0,10]] ] } ] })");
  for (const auto& [edits, word] : std::vector<std::pair<std::string, std::string>>{
           {R"({"slice":0,"contour":0,"do":"move","point":2,"to_mm":[-5,5]})", "crosses itself"},
           {moved + R"({"slice":0,"contour":0,"do":"move","point":2,"to_mm":[-5,5]})",
            "edits[1]: a contour crosses itself between its pieces 1 and 3"},
           {moved + R"({"slice":0,"contour":0,"do":"insert","piece":3,"at_mm":[14,5]})",
            "edits[1]: a contour crosses itself between its pieces 1 and 3"},
           // A contour that crosses itself from the beginning is refused at the first edit of it, wherever
           // that edit is.
           {moved + R"({"slice":0,"contour":2,"do":"move","point":4,"to_mm":[60,6]})",
            "edits[1]: a contour crosses itself between its pieces 1 and 4"},
           {R"({"slice":7,"contour":0,"do":"remove"})", "edits[0].slice: there are 2"},
           {R"({"slice":0,"contour":0,"do":"move","point":9,"to_mm":[0,0]})", "no point 9"},
           {R"({"slice":0,"contour":0,"do":"turn"})", "not 'turn'"},
           {R"({"slice":0,"contour":0,"do":"delete","pont":1})", "did you mean 'point'"}})
    expect_refused(edit(edits), word);
}

TEST_F(CommandLine, AMarginAboutABallIsABall) {
  ASSERT_EQ(run("mesh " + at("ball.nrrd") + " --window 0: -o " + at("ball.stl")).status, 0);
  const CommandAnswer answer =
      run("offset " + at("ball.stl") + " --by 3 --cell 0.75 -o " + at("margin.stl") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors;
  const SortedJson json = SortedJson::parse(answer.out);
  EXPECT_NEAR(json["volume_mm3"].get<double>(), tests::ball_mm3(15), 0.01 * tests::ball_mm3(15));
  EXPECT_EQ(json["self_intersections"], 0);
  const CommandAnswer none = run("offset " + at("ball.stl") + " --by -20 -o " + at("gone.stl") + " --json");
  ASSERT_EQ(none.status, 0) << none.errors;
  const SortedJson empty = SortedJson::parse(none.out);
  EXPECT_EQ(empty["volume_mm3"], 0.0);
  EXPECT_EQ(empty["faces"], 0);
  EXPECT_NE(empty["findings"].dump().find("empty: nothing is left of"), std::string::npos) << none.out;
  expect_refused(run("offset " + at("ball.stl") + " --by nan -o " + at("none.stl")), "nan");
  EXPECT_EQ(
      run("offset " + at("ball.stl") + " --by 3 --cell 0.05 --time-limit 0.01 -o " + at("none.stl")).status,
      3);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "none.stl"));
}

TEST(SliceContours, ComeBackFromTheirFileInAnyView) {
  for (const char* view : {"anterior", "inferior", "30,15", "-120,-40", "20,90", "20,-90"}) {
    voxel::SliceMask mask;
    mask.view = voxel::parse_view(view);
    mask.slices = {{-1.5, {{{0, 0}, {4, 0}, {4, 3}}}}, {2, {}}};
    const tests::ScratchFolder folder;
    const std::filesystem::path path = folder / "slices.json";
    std::ofstream(path) << to_json(mask).dump();
    const voxel::SliceMask back = read_slices(path);
    EXPECT_LT(glm::distance(back.view.look, mask.view.look), 1e-6) << view;
    EXPECT_LT(glm::distance(back.view.up, mask.view.up), 1e-6) << view;
    ASSERT_EQ(back.slices.size(), 2u);
    EXPECT_EQ(back.slices[0].polygons_mm, mask.slices[0].polygons_mm);
  }
}

}  // namespace
}  // namespace octotomy::planner
