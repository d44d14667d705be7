// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The verb that measures whether a mesh can be printed, on shapes whose walls and gaps are known.
#include <cmath>

#include "brep/io/write_mesh.h"
#include "brep/shape/prism.h"
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

class PrintVerbs : public tests::CommandLine {
 protected:
  /// Writes solids swept by 20 mm along y, each from a polygon (x, z), as one file.
  void write_swept(const std::string& name, const std::vector<std::vector<glm::dvec2>>& polygons_mm) {
    brep::Triangles all;
    for (const std::vector<glm::dvec2>& polygon : polygons_mm) {
      brep::Prism prism;
      prism.polygons_mm = {polygon};
      prism.to_mm = 20.0;
      add(all, brep::solid_of(prism).triangles(), false);
    }
    brep::write_mesh(all, folder_ / name);
  }

  static void add(brep::Triangles& all, const brep::Triangles& more, bool is_turned) {
    const auto first = static_cast<std::uint32_t>(all.points_mm.size());
    all.points_mm.insert(all.points_mm.end(), more.points_mm.begin(), more.points_mm.end());
    for (const auto& [a, b, c] : more.faces)
      all.faces.push_back(is_turned ? std::array{first + a, first + c, first + b}
                                    : std::array{first + a, first + b, first + c});
  }

  SortedJson printable(const std::string& name, const std::string& options = "") {
    const CommandAnswer answer =
        run("printable " + at(name) + (options.find("--voxel") == std::string::npos ? " --voxel 0.5" : "") +
            " --json " + options);
    const SortedJson json = SortedJson::parse(answer.out);
    // A FAIL is a whole answer, and the status names it to scripts.
    EXPECT_EQ(answer.status, json.at("verdict") == "FAIL" ? 1 : 0) << answer.out << answer.errors;
    return json;
  }

  static const SortedJson& line(const SortedJson& answer, const std::string& check) {
    for (const SortedJson& one : answer.at("checks"))
      if (one.at("check") == check) return one;
    ADD_FAILURE() << "no line " << check << " in " << answer.dump(1);
    return answer;
  }

  static std::vector<glm::dvec2> box(double low_x, double low_z, double high_x, double high_z) {
    return {{low_x, low_z}, {high_x, low_z}, {high_x, high_z}, {low_x, high_z}};
  }
};

TEST_F(PrintVerbs, APlateOfKnownWallPasses) {
  write_swept("plate.ply", {box(0, 0, 30, 1.2)});
  const SortedJson answer = printable("plate.ply");
  EXPECT_EQ(answer["verdict"], "PASS") << answer.dump(1);
  EXPECT_EQ(answer["checks"].size(), 9u);
  EXPECT_NEAR(line(answer, "wall")["least_mm"].get<double>(), 1.2, 1e-6);
  EXPECT_NEAR(line(answer, "wall")["voxel_least_mm"].get<double>(), 1.2,
              line(answer, "wall")["voxel_error_mm"].get<double>());
  EXPECT_TRUE(line(answer, "gap")["least_mm"].is_null());
  EXPECT_EQ(line(answer, "pieces")["voxel_count"], 1);
  EXPECT_EQ(line(answer, "cavities")["voxel_count"], 0);
  // On its edge it is as high as it was wide.
  const SortedJson size = line(printable("plate.ply", "--build-direction 1,0,0"), "bed")["size_mm"];
  EXPECT_NEAR(size[2].get<double>(), 30.0, 1e-6);
}

TEST_F(PrintVerbs, AThinWallFailsAtItsPlace) {
  // A block of 10 mm with a fin of 0.4 mm.
  write_swept("fin.ply", {{{0, 0}, {20, 0}, {20, 10}, {10.4, 10}, {10.4, 20}, {10, 20}, {10, 10}, {0, 10}}});
  const SortedJson answer = printable("fin.ply"), wall = line(answer, "wall");
  EXPECT_EQ(answer["verdict"], "FAIL");
  EXPECT_EQ(wall["verdict"], "FAIL");
  EXPECT_NEAR(wall["least_mm"].get<double>(), 0.4, 1e-6);
  EXPECT_GT(wall["at_mm"][2].get<double>(), 9.9);
  EXPECT_NE(answer["findings"][0].get<std::string>().find("the smallest wall is 0.400 mm at ("),
            std::string::npos);
  EXPECT_EQ(line(printable("fin.ply", "--least-wall 0.3"), "wall")["verdict"], "PASS");
}

TEST_F(PrintVerbs, AFailEndsWithStatusOneAndAWarnWithStatusZero) {
  write_swept("plate.ply", {box(0, 0, 30, 1.2)});
  write_swept("slot.ply", {{{0, 0}, {20, 0}, {20, 10}, {10.3, 10}, {10.3, 5}, {10, 5}, {10, 10}, {0, 10}}});
  const auto status = [&](const std::string& words) { return run("printable " + words).status; };
  EXPECT_EQ(status(at("plate.ply") + " --voxel 0.5"), 0);
  EXPECT_EQ(status(at("plate.ply") + " --voxel 0.5 --least-wall 2"), 1);
  EXPECT_EQ(printable("slot.ply")["verdict"], "WARN");
  EXPECT_EQ(status(at("slot.ply") + " --voxel 0.5"), 0);
}

TEST_F(PrintVerbs, APlanWhosePartFailsItsProofEndsWithStatusOneAndWritesEverything) {
  const std::string start =
      R"({ "octotomy_plan": 1, "name": "ball", "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
        { "id": "prints", "do": "printable", "object": "ball", "least_wall_mm": )";
  write("thick.plan.json", start + R"(2 } ] })");
  write("thin.plan.json", start + R"(10, "bed_mm": [20, 20, 20] } ] })");
  const CommandAnswer good = run("run " + at("thick.plan.json") + " -o " + at("good") + " --json");
  EXPECT_EQ(good.status, 0) << good.errors;
  EXPECT_EQ(SortedJson::parse(good.out)["counts"]["measured"]["FAIL"], 0);
  const CommandAnswer bad = run("run " + at("thin.plan.json") + " -o " + at("bad") + " --json");
  EXPECT_EQ(bad.status, 1) << bad.errors;
  EXPECT_NE(bad.errors.find("a FAIL verdict of 'prints': FAIL, bed: "), std::string::npos) << bad.errors;
  const SortedJson json = SortedJson::parse(bad.out);
  EXPECT_EQ(json["counts"]["measured"], SortedJson::parse(R"({"PASS": 0, "WARN": 0, "FAIL": 1})"));
  EXPECT_EQ(json["counts"]["FAIL"], 0) << "the kernels agree";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "bad/report.html"));
}

TEST_F(PrintVerbs, ASlotIsAGapAndTwoPiecesFail) {
  write_swept("two.ply", {box(0, 0, 30, 5), box(0, 5.3, 30, 10)});
  const SortedJson answer = printable("two.ply");
  EXPECT_EQ(line(answer, "pieces")["verdict"], "FAIL");
  EXPECT_EQ(line(answer, "pieces")["count"], 2);
  EXPECT_EQ(line(answer, "gap")["verdict"], "WARN");
  EXPECT_NEAR(line(answer, "gap")["least_mm"].get<double>(), 0.3, 1e-6);
  // The upper piece hangs by its whole lower side.
  EXPECT_EQ(line(answer, "overhang")["verdict"], "WARN");
  EXPECT_NEAR(line(answer, "overhang")["area_mm2"].get<double>(), 600.0, 1e-3);
  EXPECT_NEAR(line(answer, "overhang")["at_mm"][2].get<double>(), 5.3, 1e-3);
}

TEST_F(PrintVerbs, AClosedCavityFailsAtItsPlace) {
  brep::Prism outer, inner;
  outer.polygons_mm = {box(0, 0, 10, 10)};
  outer.to_mm = 10.0;
  inner.polygons_mm = {box(4, 4, 6, 6)};
  inner.from_mm = 4.0;
  inner.to_mm = 6.0;
  brep::Triangles hollow;
  add(hollow, brep::solid_of(outer).triangles(), false);
  add(hollow, brep::solid_of(inner).triangles(), true);
  brep::write_mesh(hollow, folder_ / "hollow.ply");
  const SortedJson cavities = line(printable("hollow.ply"), "cavities");
  EXPECT_EQ(cavities["verdict"], "FAIL");
  EXPECT_EQ(cavities["count"], 1);
  EXPECT_EQ(cavities["voxel_count"], 1);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(cavities["at_mm"][axis].get<double>(), 5.0, 1.1);
}

TEST_F(PrintVerbs, SpoiledSurfacesFailByTheirOwnLineWithThePlace) {
  brep::Prism prism;
  prism.polygons_mm = {box(0, 0, 10, 10)};
  prism.to_mm = 10.0;
  const brep::Triangles good = brep::solid_of(prism).triangles();
  brep::Triangles open = good, inside_out, crossing = good;
  open.faces.pop_back();
  brep::write_mesh(open, folder_ / "open.ply");
  add(inside_out, good, true);
  brep::write_mesh(inside_out, folder_ / "inside_out.ply");
  prism.polygons_mm = {box(5, 5, 15, 15)};
  prism.from_mm = 5.0;
  prism.to_mm = 15.0;
  add(crossing, brep::solid_of(prism).triangles(), false);
  brep::write_mesh(crossing, folder_ / "crossing.ply");
  for (const auto& [file, check] : {std::pair("open.ply", "closed"), std::pair("inside_out.ply", "outward"),
                                    std::pair("crossing.ply", "self_crossing")}) {
    const SortedJson answer = printable(file);
    EXPECT_EQ(answer["verdict"], "FAIL") << file;
    EXPECT_EQ(line(answer, check)["verdict"], "FAIL") << answer.dump(1);
    EXPECT_TRUE(line(answer, check)["at_mm"].is_array()) << answer.dump(1);
    EXPECT_TRUE(line(answer, "wall")["verdict"].is_null()) << file;
  }
}

TEST_F(PrintVerbs, APartThatTheBedDoesNotHoldFailsUnlessItFitsTurned) {
  write_swept("long.ply", {box(0, 0, 180, 5)});
  const SortedJson bed = line(printable("long.ply", "--voxel 2"), "bed");
  EXPECT_EQ(bed["verdict"], "PASS") << bed.dump(1);  // 180 mm, turned to the diagonal of 145 mm
  EXPECT_NEAR(bed["turned_deg"].get<double>(), 45.0, 10.0);
  EXPECT_EQ(line(printable("long.ply", "--voxel 2 --bed 100,100,100"), "bed")["verdict"], "FAIL");
}

TEST_F(PrintVerbs, RefusesABedWithoutWidthAndALimitOutOfRange) {
  write_swept("plate.ply", {box(0, 0, 30, 1.2)});
  expect_refused(run("printable " + at("plate.ply") + " --bed 0,100,100"), "three lengths above 0");
  expect_refused(run("printable " + at("plate.ply") + " --least-wall 0"), "least");
  expect_refused(run("printable " + at("plate.ply") + " --build-direction 0,0,0"), "direction");
}

}  // namespace
}  // namespace octotomy::planner
