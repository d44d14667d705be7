// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Surfaces as other programs leave them, through the verbs that take any of them.
#include <algorithm>
#include <fstream>
#include <sstream>

#include "tests/brep/bad_meshes.h"
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

class BadSurfaces : public tests::CommandLine {
 protected:
  std::string off(const std::string& name, const brep::Triangles& t) {
    std::ostringstream text;
    text.precision(17);
    text << "OFF\n" << t.points_mm.size() << " " << t.faces.size() << " 0\n";
    for (const glm::dvec3& p : t.points_mm) text << p.x << " " << p.y << " " << p.z << "\n";
    for (const auto& f : t.faces) text << "3 " << f[0] << " " << f[1] << " " << f[2] << "\n";
    write(name, text.str());
    return at(name);
  }
  SortedJson json_of(const std::string& command) {
    const CommandAnswer answer = run(command + " --json");
    EXPECT_EQ(answer.status, 0) << command << ": " << answer.errors;
    return answer.status == 0 ? SortedJson::parse(answer.out) : SortedJson();
  }
};

TEST_F(BadSurfaces, AreOutlinedAsTheyAreAndTheirOutlinesTiled) {
  using namespace brep::shapes;
  // Two cubes meet in an upright edge of four triangles, so that their contours touch in every plane.
  const std::string cubes =
      off("cubes.off", welded(together(box({0, 0, 0}, {10, 10, 10}), box({10, 10, 0}, {20, 20, 10}))));
  const SortedJson lines = json_of("outline " + cubes + " --at 2,4,6,8 -o " + at("cubes.json"));
  EXPECT_FALSE(lines["findings"].empty());
  EXPECT_EQ(lines["contours"], 8);
  EXPECT_NEAR(lines["slices"][1]["area_mm2"].get<double>(), 200.0, 0.001);
  const SortedJson tiled = json_of("mesh " + at("cubes.json") + " -o " + at("tiled.stl"));
  EXPECT_EQ(tiled["components"], 2);
  EXPECT_EQ(tiled["self_intersections"], 0);
  EXPECT_NEAR(tiled["volume_mm3"].get<double>(), 200.0 * 8.0, 20.0);
  // A cube without its side at x = 10 leaves open lines.
  brep::Triangles open = box({0, 0, 0}, {10, 10, 10});
  std::erase_if(open.faces, [&](const auto& face) {
    return std::all_of(face.begin(), face.end(), [&](const auto k) { return open.points_mm[k].x == 10.0; });
  });
  ASSERT_EQ(open.faces.size(), 10u);
  const std::string cup = off("cup.off", welded(together(open, box({30, 0, 0}, {40, 10, 10}))));
  const SortedJson half = json_of("outline " + cup + " --at 3,6 -o " + at("cup.json"));
  EXPECT_EQ(half["contours"], 2) << "of the closed cube";
  EXPECT_NE(half["findings"].dump().find("2 contours that end at its border were left out"),
            std::string::npos)
      << half["findings"];
}

TEST_F(BadSurfaces, AreComparedMirroredAndMeasuredAsTheyAre) {
  using namespace brep::shapes;
  const std::string cubes =
      off("cubes.off", welded(together(box({0, 0, 0}, {10, 10, 10}), box({10, 10, 0}, {20, 20, 10}))));
  const SortedJson same = json_of("compare " + cubes + " " + cubes);
  EXPECT_EQ(same["hausdorff_mm"], 0.0);
  EXPECT_EQ(same["dice"], 1.0);
  EXPECT_NE(same["findings"][0].get<std::string>().find("edge of 4 triangles at (10, 10, 5) mm"),
            std::string::npos);
  EXPECT_EQ(run("mirror " + cubes + " --plane 0,0,0 1,0,0 --exactly -o " + at("m.ply")).status, 0);
  const SortedJson open =
      json_of("measure " + off("open.off", without(box({0, 0, 0}, {10, 10, 10}), {0, 1})));
  EXPECT_NEAR(open["area_mm2"].get<double>(), 500.0, 1e-9);
  EXPECT_TRUE(open["volume_mm3"].is_null());
}

TEST_F(BadSurfaces, OfTwoThatCannotBeReadTheFirstIsNamed) {
  write("a.off", "OFF\n3 1 0\n");
  write("b.off", "OFF\n");
  for (int i = 0; i < 10; ++i) {
    const CommandAnswer answer = run("compare " + at("a.off") + " " + at("b.off"));
    EXPECT_EQ(answer.status, 2);
    EXPECT_NE(answer.errors.find("a.off"), std::string::npos) << answer.errors;
    EXPECT_EQ(answer.errors.find("b.off"), std::string::npos) << answer.errors;
  }
}

TEST_F(BadSurfaces, AreToldUnweldedAndWhatWeldingCloses) {
  const SortedJson info =
      json_of("info " + off("soup.off", brep::shapes::unwelded(brep::shapes::sphere({0, 0, 0}, 5, 1))));
  EXPECT_EQ(info["open_edges"], 240);
  EXPECT_EQ(info["open_edges_closed_by_welding"], 240);
  EXPECT_EQ(info["coincident_points"], 240 - 42);
  EXPECT_NE(info["findings"][1].get<std::string>().find("unwelded: 240 of 240 open edges close when welded"),
            std::string::npos);
}

TEST_F(BadSurfaces, BecomeASolidThatTheBooleanTakesAndTheChangeIsTold) {
  using namespace brep::shapes;
  const brep::Triangles ball = sphere({0, 0, 0}, 5, 3), beside = sphere({6, 0.3, 0.2}, 5, 3);
  const std::string heap = off("heap.off", together(ball, beside));
  expect_refused(run("boolean " + heap + " difference " + heap + " -o " + at("b.ply")),
                 "repair heap.off --solid");
  const SortedJson made = json_of("repair " + heap + " --solid -o " + at("solid.ply"));
  EXPECT_EQ(made["method"], "mended");
  const SortedJson united = json_of("boolean " + off("ball.off", ball) + " union " +
                                    off("beside.off", beside) + " -o " + at("united.ply"));
  EXPECT_NEAR(made["volume_after_mm3"].get<double>(), united["volume_mm3"].get<double>(), 1e-6);
  EXPECT_TRUE(made["health"]["closed"]);
  EXPECT_EQ(made["health"]["self_intersections"], 0);
  EXPECT_NEAR(made["volume_after_mm3"].get<double>(), made["volume_before_mm3"].get<double>(), 10.0);
  EXPECT_LT(made["largest_distance_mm"].get<double>(), 5.0);  // the lens inside is gone
  EXPECT_GT(made["largest_distance_mm"].get<double>(), 1.0);
  EXPECT_EQ(run("boolean " + at("solid.ply") + " difference " + off("box.off", box({0, -9, -9}, {9, 9, 9})) +
                " -o " + at("b.ply"))
                .status,
            0);
  expect_refused(run("repair " + off("sheet.off", sheet(4, 10)) + " --solid -o " + at("s.ply")),
                 "encloses a volume: there are only sheets");
  EXPECT_FALSE(std::filesystem::exists(at("s.ply")));
}

TEST_F(BadSurfaces, ABooleanThinnerThanRoundingIsMadeExactly) {
  using namespace brep::shapes;
  brep::Triangles thick = box({0, 0, 0}, {10, 10, 10});
  for (glm::dvec3& p : thick.points_mm)
    if (p.x > 5.0) p.x += 4e-15;
  const CommandAnswer thin =
      run("boolean " + off("thick.off", thick) + " difference " +
          off("cube.off", box({0, 0, 0}, {10, 10, 10})) + " -o " + at("film.off") + " --json");
  // The answer is a film, or the proof that there is none.
  EXPECT_TRUE(thin.status == 0 || thin.errors.find("exact numbers") != std::string::npos) << thin.errors;
}

TEST_F(BadSurfaces, AreDrawnAloneAndOutlined) {
  using namespace brep::shapes;
  const std::string soup = off("soup.off", unwelded(sphere({0, 0, 0}, 20, 2)));
  const SortedJson alone = json_of("render " + soup + " -o " + at("alone.png") + " --size 100x100");
  EXPECT_GT(alone["lit_pixels"].get<int>(), 3000);
  const SortedJson slice = json_of("slice " + at("ball.nrrd") + " -o " + at("s.png") + " --octree " + soup);
  EXPECT_GT(slice["outlines"][0]["outline_pixels"].get<int>(), 10);
  EXPECT_EQ(run("slice " + soup + " -o " + at("own.png")).status, 0);
}

TEST_F(BadSurfaces, TrianglesThatShareNoPointAreWeldedForVoxels) {
  using namespace brep::shapes;
  const std::string soup = off("soup.off", unwelded(sphere({0, 0, 0}, 20, 2)));
  const std::string whole = off("whole.off", sphere({0, 0, 0}, 20, 2));
  const SortedJson made = json_of("voxelise " + soup + " --voxel 1 -o " + at("soup.octree"));
  EXPECT_EQ(made["findings"].dump().find("winds"), std::string::npos) << made.dump();
  EXPECT_EQ(made["levels"], json_of("voxelise " + whole + " --voxel 1 -o " + at("whole.octree"))["levels"]);
}

}  // namespace
}  // namespace octotomy::planner
