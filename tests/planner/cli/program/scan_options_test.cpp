// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The options about a scan mean the same to every verb that reads one: a raw file with its layout said is the
// NRRD of the same samples.
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "tests/planner/ball_scan.h"
#include "tests/run_command.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::planner {
namespace {

using tests::quoted;

class ScanOptions : public testing::Test {
 protected:
  ScanOptions() {
    const voxel::Scene ball = tests::ball_scene(12.0, 32);
    voxel::write_scene(ball, folder_ / "ball.nrrd");
    write_raw(ball, "ball.raw");
    std::ofstream(folder_ / "ball.plan.json") << R"({ "octotomy_plan": 1, "name": "ball",
      "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 },
                 { "id": "size", "do": "measure", "object": "ball" } ] })";
  }
  void write_raw(const voxel::Scene& scene, const std::string& name) const {
    const auto& samples = std::get<voxel::Int16Samples>(scene.samples);
    std::ofstream(folder_ / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(samples.data()),
               static_cast<std::streamsize>(samples.size() * sizeof samples[0]));
  }
  tests::CommandAnswer run(const std::string& arguments) const {
    return tests::run_command(std::string(OCTOTOMY_BINARY_DIR) + "/octotomy " + arguments, folder_.path());
  }
  SortedJson json(const std::string& arguments) const {
    const tests::CommandAnswer answer = run(arguments + " --json");
    EXPECT_EQ(answer.status, 0) << answer.errors;
    SortedJson said = answer.status == 0 ? SortedJson::parse(answer.out) : SortedJson();
    return said;
  }
  std::string at(const std::string& name) const { return quoted(folder_ / name); }

  tests::ScratchFolder folder_;
  const std::string layout_ = " --raw 32x32x32 int16 --spacing 1,1,1";
};

TEST_F(ScanOptions, RenderDrawsARawFileAsTheNrrdOfTheSameSamples) {
  const SortedJson nrrd = json("render " + at("ball.nrrd") + " --window 0: -o " + at("a.png"));
  const SortedJson raw = json("render " + at("ball.raw") + layout_ + " --window 0: -o " + at("b.png"));
  EXPECT_GT(raw["lit_pixels"], 0);
  EXPECT_EQ(raw["lit_pixels"], nrrd["lit_pixels"]);
  EXPECT_EQ(raw["depth_range_mm"], nrrd["depth_range_mm"]);
}

TEST_F(ScanOptions, OptionsThatWouldChangeNothingAreRefused) {
  const std::string ball = at("ball.nrrd");
  ASSERT_EQ(run("octree " + ball + " --window 0: -o " + at("ball.octree")).status, 0);
  std::ofstream(folder_ / "r.json") << R"({"polygons_mm": [[[-5, -5], [5, -5], [5, 5], [-5, 5]]]})";
  const std::string mask = "mask -o " + at("m.octree") + " --region anterior:" + at("r.json");
  for (const auto& [command, option] : {
           std::pair<std::string, std::string>{"convert " + ball + " -o " + at("x.nii") + " --label B",
                                               "--label"},
           {"convert " + ball + " -o " + at("x") + " --label B", "--label"},
           {"convert " + ball + " -o " + at("x.nii") + " --source " + ball, "--source"},
           {"convert " + ball + " -o " + at("x") + " --other-identity", "--other-identity"},
           {"convert " + at("ball.octree") + " -o " + at("x.dcm") + " --other-identity", "--other-identity"},
           {"convert " + at("ball.octree") + " -o " + at("x.dcm") + " --dicom", "--dicom"},
           {"segment " + ball + " --window 0: -o " + at("x.octree") + " --structure B", "regions"},
           {mask + " --like " + ball + " --structure B", "slices"},
           {mask + " --like " + ball + " --bridge 2", "slices"},
           {mask + " --like " + at("ball.octree") + " --voxel 2", "--voxel"},
           {mask + " --edit " + at("ball.octree") + " --voxel 2", "--voxel"},
       }) {
    const tests::CommandAnswer answer = run(command);
    EXPECT_EQ(answer.status, 2) << command;
    EXPECT_NE(answer.errors.find(option), std::string::npos) << command << "\n" << answer.errors;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.nii"));
  EXPECT_EQ(run("convert " + at("ball.octree") + " -o " + at("x.dcm") + " --label B").status, 0);
  EXPECT_EQ(run(mask + " --like " + ball + " --voxel 2").status, 0);
}

TEST_F(ScanOptions, RunTakesARawFileInTheScansPlace) {
  const SortedJson nrrd = json("verify " + at("ball.plan.json"));
  const SortedJson raw = json("verify " + at("ball.plan.json") + " --scan ct=" + at("ball.raw") + layout_);
  EXPECT_EQ(raw["certificates"][0]["voxel"]["volume_mm3"], nrrd["certificates"][0]["voxel"]["volume_mm3"]);
  const tests::CommandAnswer without =
      run("verify " + at("ball.plan.json") + " --scan ct=" + at("ball.raw") + " --json");
  EXPECT_EQ(without.status, 2);
}

TEST_F(ScanOptions, LookAtARawFileLeavesAPlanThatRunReplays) {
  const SortedJson look = json("look " + at("ball.raw") + layout_ + " --bone 0 --skin -500 -o " + at("look"));
  std::ofstream(folder_ / "look.plan.json") << look["plan"];
  const SortedJson replayed = json("run " + at("look.plan.json") + " -o " + at("again"));
  EXPECT_EQ(replayed["objects"][0]["voxel"], look["objects"][0]["voxel"]);
  EXPECT_FALSE(look["objects"].empty());
}

TEST_F(ScanOptions, OutcomeTakesThemForTheLaterScan) {
  json("phantom head --voxel 12 -o " + at("head.nrrd"));
  write_raw(voxel::read_scene(folder_ / "head.nrrd"), "head.raw");
  std::ofstream(folder_ / "head.plan.json") << R"({ "octotomy_plan": 1, "name": "head",
    "scans": { "ct": { "path": "head.nrrd" } }, "universe": { "voxel_mm": 12 },
    "steps": [ { "id": "skull", "do": "window", "scan": "ct", "low": 300 },
               { "id": "moved", "do": "move", "object": "skull", "translate_mm": [0, -6, 2] },
               { "id": "both", "do": "combine", "expression": "skull | moved" } ] })";
  const SortedJson nrrd = json("outcome " + at("head.plan.json") + " " + at("head.nrrd"));
  const SortedJson raw = json("outcome " + at("head.plan.json") + " " + at("head.raw") +
                              " --raw 17x21x21 int16 --spacing 12,12,12");
  ASSERT_EQ(nrrd.at("pieces").size(), 1u);
  ASSERT_EQ(raw.at("pieces").size(), 1u);
  EXPECT_EQ(raw.at("pieces").at(0).at("object"), nrrd.at("pieces").at(0).at("object"));
  // A raw file has no frame: it is laid on the planned scan.
  EXPECT_LT(raw.at("unmoved").at("rms_mm").get<double>(), 0.1);
}

TEST_F(ScanOptions, LookTakesAPatternOfImagesAndRunReplaysItsPlan) {
  // A bar through nine slices of 24 x 20 pixels.
  for (int z = 0; z < 9; ++z) {
    std::ofstream slice(folder_ / ("s" + std::to_string(z) + ".pgm"), std::ios::binary);
    slice << "P5 24 20 255\n";
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 24; ++x) slice.put(x >= 6 && x < 18 && y >= 5 && y < 15 && z > 0 ? '\xc8' : '\x0a');
  }
  const std::string stack = quoted(folder_ / "s*.pgm") + " --spacing 1,1,1";
  const SortedJson look = json("look " + stack + " --bone 100 --skin 50 -o " + at("look"));
  EXPECT_EQ(look["scans"][0]["dims"], SortedJson({24, 20, 9}));
  std::ofstream(folder_ / "look.plan.json") << look["plan"];
  const SortedJson replayed = json("run " + at("look.plan.json") + " -o " + at("again"));
  EXPECT_EQ(replayed["objects"][0]["voxel"], look["objects"][0]["voxel"]);
  EXPECT_EQ(replayed["scans"][0]["sha256"], look["scans"][0]["sha256"]);
}

TEST_F(ScanOptions, AreRefusedOfOctreesAndMeshesWhichTheyDoNotChange) {
  ASSERT_EQ(run("segment " + at("ball.nrrd") + " --window 0: -o " + at("ball.octree")).status, 0);
  ASSERT_EQ(run("mesh " + at("ball.octree") + " -o " + at("ball.stl")).status, 0);
  for (const char* option :
       {"--series 2", "--join", "--slices 1:2", "--spacing 1,1,1", "--raw 2x2x2 int16", "--frame RAS"})
    for (const char* verb : {"info ", "measure "})
      for (const char* file : {"ball.octree", "ball.stl"}) {
        if (std::string(file) == "ball.stl" && std::string(option) == "--frame RAS") continue;
        const tests::CommandAnswer answer = run(verb + at(file) + " " + option);
        EXPECT_EQ(answer.status, 2) << verb << file << option;
        EXPECT_NE(answer.errors.find(": leave it out"), std::string::npos) << answer.errors;
      }
  EXPECT_EQ(run("measure " + at("ball.stl") + " --frame RAS").status, 0);
}

TEST_F(ScanOptions, AreRefusedInOneLineWhereTheyMeanNothing) {
  for (const std::string& arguments :
       {std::string("render ") + at("ball.raw") + " --raw 32x32 int16 -o " + at("x.png"),
        "look " + at("ball.raw") + " --raw 32x32x32 short -o " + at("x"),
        "render " + at("ball.nrrd") + " --offset 5 -o " + at("x.png")}) {
    const tests::CommandAnswer answer = run(arguments);
    EXPECT_EQ(answer.status, 2) << arguments;
    EXPECT_EQ(std::count(answer.errors.begin(), answer.errors.end(), '\n'), 1) << answer.errors;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.png"));
}

}  // namespace
}  // namespace octotomy::planner
