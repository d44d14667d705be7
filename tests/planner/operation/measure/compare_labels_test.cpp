// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/measure/compare_labels.h"

#include "tests/planner/cli/program/command_line.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

using tests::CommandAnswer;
using tests::SortedJson;

class CompareLabels : public tests::CommandLine {
 protected:
  /// A block of 10 x 10 x 10 samples of 1 mm that begins at `from`, and one sample of label 9 where wanted.
  void put(const std::string& name, int from, std::int16_t label, bool has_nine = false,
           double origin_mm = 0.0) const {
    voxel::Scene scene;
    scene.lattice = voxel::axis_aligned_lattice({24, 24, 24}, {1, 1, 1}, glm::dvec3(origin_mm));
    scene.meaning = voxel::Meaning::Label;
    voxel::Int16Samples samples(24 * 24 * 24, 0);
    const auto at = [](int x, int y, int z) { return static_cast<std::size_t>(x + 24 * (y + 24 * z)); };
    for (int z = 5; z < 15; ++z)
      for (int y = 5; y < 15; ++y)
        for (int x = from; x < from + 10; ++x) samples[at(x, y, z)] = label;
    if (has_nine) samples[at(20, 20, 20)] = 9;
    scene.samples = std::move(samples);
    voxel::write_scene(scene, folder_ / name);
  }
  SortedJson compared(const std::string& a, const std::string& b) const {
    const CommandAnswer answer = run("compare " + at(a) + " " + at(b) + " --json");
    EXPECT_EQ(answer.status, 0) << answer.errors;
    return SortedJson::parse(answer.out);
  }
};

TEST_F(CompareLabels, BlocksThatAreShiftedHaveTheDiceAndDistancesOfTheirOverlap) {
  put("a.nrrd", 5, 3);
  put("b.nrrd", 7, 3);
  const SortedJson json = compared("a.nrrd", "b.nrrd");
  EXPECT_NEAR(json["dice"].get<double>(), 0.8, 1e-12);
  ASSERT_EQ(json["labels"].size(), 1u);
  const SortedJson& label = json["labels"][0];
  EXPECT_EQ(label["label"], 3);
  EXPECT_NEAR(label["dice"].get<double>(), 0.8, 1e-12);
  EXPECT_NEAR(label["volume_a_mm3"].get<double>(), 1000.0, 1e-9);
  EXPECT_NEAR(label["volume_b_mm3"].get<double>(), 1000.0, 1e-9);
  EXPECT_NEAR(label["hausdorff_mm"].get<double>(), 2.0, 0.05);
  EXPECT_NEAR(json["hausdorff_mm"].get<double>(), 2.0, 0.05);
  EXPECT_GT(json["mean_mm"].get<double>(), 0.2);
  EXPECT_LT(json["mean_mm"].get<double>(), 1.5);
  EXPECT_TRUE(json.contains("hausdorff95_mm"));
  EXPECT_TRUE(json.contains("definition"));
}

TEST_F(CompareLabels, EqualMapsOfAnotherLatticeAndNumbersAreStillEqualAndALabelOfOneSideIsTold) {
  put("a.nrrd", 5, 3, true);
  put("b.nrrd", 3, 3, false, 2.0);  // x from 5 mm as in a; y and z are shifted by 2 mm
  const SortedJson json = compared("a.nrrd", "b.nrrd");
  ASSERT_EQ(json["labels"].size(), 2u);
  EXPECT_NEAR(json["labels"][0]["dice"].get<double>(), 0.64, 1e-12);
  EXPECT_EQ(json["labels"][1]["label"], 9);
  EXPECT_EQ(json["labels"][1]["dice"], 0.0);
  EXPECT_TRUE(json["labels"][1]["mean_mm"].is_null());
  const std::string findings = json["findings"].dump();
  EXPECT_NE(findings.find("different lattices"), std::string::npos) << findings;
  EXPECT_NE(findings.find("is only in"), std::string::npos) << findings;
}

TEST_F(CompareLabels, AMapThatIsStoredInAnotherOrderIsTheSame) {
  voxel::Scene scene;
  const glm::ivec3 dims(20, 18, 16);
  scene.lattice = voxel::axis_aligned_lattice(dims, {0.7, 0.7, 1.2}, {-3, 2, 1});
  scene.meaning = voxel::Meaning::Label;
  const auto is_inside = [](const glm::ivec3& p) {
    const glm::dvec3 off = (glm::dvec3(p) - glm::dvec3(9, 8, 7)) * glm::dvec3(0.7, 0.7, 1.2);
    return glm::length(off) < 4.3 && off.x + 0.4 * off.y < 2.0;
  };
  voxel::Int16Samples samples, flipped;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        samples.push_back(is_inside({x, y, z}) ? 1 : 0);
        flipped.push_back(is_inside({dims.x - 1 - x, y, dims.z - 1 - z}) ? 1 : 0);
      }
  scene.samples = samples;
  voxel::write_scene(scene, folder_ / "a.nrrd");
  scene.samples = flipped;
  scene.lattice.lps_from_voxel[3] = glm::dvec4(scene.lattice.lps_mm({dims.x - 1, 0, dims.z - 1}), 1.0);
  scene.lattice.lps_from_voxel[0] *= -1.0;
  scene.lattice.lps_from_voxel[2] *= -1.0;
  voxel::write_scene(scene, folder_ / "b.nrrd");
  const SortedJson json = compared("a.nrrd", "b.nrrd");
  EXPECT_EQ(json["labels"][0]["dice"], 1.0);
  EXPECT_LT(json["labels"][0]["hausdorff_mm"].get<double>(), 1e-9) << json;
  EXPECT_EQ(json["findings"].dump().find("different lattices"), std::string::npos) << json["findings"];
}

TEST_F(CompareLabels, LabelsArePairedByNameAndNumbersThatContradictNamesAreReported) {
  put("a.nrrd", 5, 3, true);
  put("b.nrrd", 5, 7, true);
  write("a.csv", "3,Mandible\n9,Tooth\n");
  const SortedJson by_number = compared("a.nrrd", "b.nrrd");
  EXPECT_EQ(by_number["labels"].size(), 3u);
  EXPECT_NE(by_number["findings"].dump().find("paired by number, because only"), std::string::npos);
  write("b.csv", "7,Mandible\n9,Skull\n");
  const SortedJson json = compared("a.nrrd", "b.nrrd");
  ASSERT_EQ(json["labels"].size(), 3u);
  EXPECT_EQ(json["labels"][0]["name"], "Mandible");
  EXPECT_EQ(json["labels"][0]["label"], 3);
  EXPECT_EQ(json["labels"][0]["dice"], 1.0);
  EXPECT_NEAR(json["labels"][0]["hausdorff_mm"].get<double>(), 0.0, 1e-9);
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_EQ(json["labels"][i]["label"], 9);
    EXPECT_EQ(json["labels"][i]["dice"], 0.0) << "Tooth and Skull have one number and nothing in common";
  }
  const std::string findings = json["findings"].dump();
  EXPECT_NE(findings.find("number 9 is 'Tooth' in"), std::string::npos) << findings;
  EXPECT_NE(findings.find("'Skull' (9) is only in"), std::string::npos) << findings;
  write("b.csv", "7,Mandible\n9,Tooth\n");
  EXPECT_EQ(compared("a.nrrd", "b.nrrd")["findings"].dump().find("number"), std::string::npos);
}

TEST_F(CompareLabels, ANameOfTwoLabelsPairsNothing) {
  const auto segments = [&](const std::string& file, const std::string& second) {
    write(file,
          "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 3 3 3\n"
          "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: ascii\n"
          "Segment0_Name:=Bone\nSegment0_LabelValue:=1\nSegment1_Name:=" +
              second + "\nSegment1_LabelValue:=2\n\n1 1 1 1 1 1 1 1 1 0 0 0 0 0 0 0 0 0 2 2 2 2 2 2 2 2 2\n");
  };
  segments("a.seg.nrrd", "Bone");
  segments("b.seg.nrrd", "Fat");
  expect_refused(run("compare " + at("a.seg.nrrd") + " " + at("b.seg.nrrd")),
                 "the labels 1 and 2 are both named 'Bone'");
  EXPECT_EQ(compared("b.seg.nrrd", "b.seg.nrrd")["dice"], 1.0);
}

TEST_F(CompareLabels, AScanASurfaceOrAnEmptyMapIsRefused) {
  put("a.nrrd", 5, 3);
  put("none.nrrd", 5, 0);
  expect_refused(run("compare " + at("a.nrrd") + " " + at("ball.nrrd")), "is not a label map");
  expect_refused(run("compare " + at("a.nrrd") + " " + at("none.nrrd")), "contains no labels");
  write("s.stl", "solid\nendsolid\n");
  expect_refused(run("compare " + at("a.nrrd") + " " + at("s.stl")), "octotomy surfaces");
  expect_refused(run("compare " + at("a.nrrd") + " " + at("a.nrrd") + " -o " + at("x.ply")), "--out");
}

}  // namespace
}  // namespace octotomy::planner
