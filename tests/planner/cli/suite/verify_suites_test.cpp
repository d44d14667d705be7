// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <map>

#include "brep/io/write_mesh.h"
#include "tests/file_bytes.h"
#include "tests/planner/cli/program/command_line.h"
#include "verify/certificate/general_position.h"
#include "verify/question/random_expression.h"
#include "voxel/filter/crop.h"
#include "voxel/filter/label_map.h"
#include "voxel/scan/read_scene.h"
#include "voxel/scan/write_scene.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/octree_file.h"

namespace octotomy::planner {
namespace {

/// Two random sets of voxels as meshes and as label maps.
class Verify : public tests::CommandLine {
 protected:
  Verify() {
    voxel::Universe universe;
    universe.depth = 4;
    verify::Random random(11);
    std::vector<voxel::Octree> sets;
    for (const char* name : {"a.nrrd", "b.nrrd"}) {
      sets.push_back(verify::random_set(random, universe, 12).octree);
      voxel::write_scene(voxel::label_map(universe.lattice(), {&sets.back(), 1}).scene, folder_ / name);
    }
    // Surfaces that do not touch themselves, as those of noise would.
    const verify::GeneralPosition position = verify::general_position(sets);
    brep::write_mesh(position.operands[0].solid, folder_ / "a.ply");
    brep::write_mesh(position.operands[1].solid, folder_ / "b.ply");
  }
};

TEST_F(Verify, RandomQuestionsAgreeAndAreTheSameOfTheSameSeed) {
  const auto first = run("verify --random 2 --seed 5 --json --failures " + at("failures"));
  ASSERT_EQ(first.status, 0) << first.errors << first.out;
  const tests::SortedJson json = tests::SortedJson::parse(first.out);
  EXPECT_EQ(json["exact"]["verdicts"]["PASS"], 2);
  EXPECT_EQ(json["counts"]["FAIL"], 0);
  EXPECT_EQ(json["disagreements"].size(), 0U);
  EXPECT_GE(json["certificates"].size(), 2U);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "failures"));
  const tests::SortedJson one =
      tests::SortedJson::parse(run("verify --random 1 --seed 6 --threads 1 --json").out);
  EXPECT_EQ(one["certificates"][0]["operation"], json["certificates"][1]["operation"]);
  EXPECT_EQ(one["certificates"][0]["mesh"], json["certificates"][1]["mesh"]);
}

TEST_F(Verify, OfItselfFindsAPartOfAnotherBuildAndOneThatIsDamaged) {
  const auto sound = run("verify --self --json");
  EXPECT_EQ(sound.status, 0) << sound.out;
  const tests::SortedJson parts = tests::SortedJson::parse(sound.out)["parts"];
  EXPECT_EQ(parts.size(), 5U);
  // Every library that decodes data of unknown origin states its version, and its faults what they mean here.
  const tests::SortedJson whole = tests::SortedJson::parse(sound.out);
  for (const char* library : {"GDCM", "OpenJPEG", "OpenImageIO", "ITK", "TetGen", "libcurl", "OpenSSL",
                              "zlib", "zstd", "libtiff", "libpng"}) {
    ASSERT_TRUE(whole["libraries"].contains(library)) << library;
    const auto version = whole["libraries"][library].get<std::string>();
    EXPECT_NE(version.find_first_of("0123456789"), std::string::npos) << library << " " << version;
  }
  std::map<std::string, tests::SortedJson> faults;
  for (const tests::SortedJson& fault : whole["known_faults"]) faults[fault["fault"]] = fault;
  ASSERT_EQ(faults.count("CVE-2026-3650"), 1U) << sound.out;
  EXPECT_EQ(faults["CVE-2026-3650"]["reached"], false);
  ASSERT_EQ(faults.count("CVE-2026-50003"), 1U) << sound.out;
  EXPECT_NE(faults["CVE-2026-50003"]["meaning"].get<std::string>().find("not linked"), std::string::npos);
  // Pictures are read in the program itself.
  for (const auto& [name, fault] : faults)
    EXPECT_EQ(fault["reached"].get<bool>(),
              fault["meaning"].get<std::string>().find("called in this program") != std::string::npos ||
                  fault["meaning"].get<std::string>().find("decodes") != std::string::npos)
        << name;
  const std::filesystem::path helpers = folder_ / "helpers";
  std::filesystem::create_directory(helpers);
  for (const tests::SortedJson& part : parts)
    std::filesystem::copy(part["path"].get<std::string>(), helpers / part["part"].get<std::string>());
  const auto spoil = [&](const std::string& name, const std::function<void(std::string&, std::size_t)>& how) {
    std::string bytes = tests::bytes_of(helpers / name);
    const std::size_t mark = bytes.find("octotomy build mark ");
    ASSERT_NE(mark, std::string::npos) << name;
    how(bytes, mark);
    std::ofstream(helpers / name, std::ios::binary) << bytes;
  };
  spoil("octotomy-tetgen", [](std::string& bytes, std::size_t mark) {
    char& digit = bytes[mark + 25];
    digit = digit == '0' ? '1' : '0';
  });
  spoil("octotomy-mesh3", [](std::string& bytes, std::size_t mark) { bytes.resize(mark); });
  std::filesystem::remove(helpers / "octotomy_dicom_codec");
  const auto spoiled = tests::run_command(
      "OCTOTOMY_HELPERS=" + at("helpers") + " " + OCTOTOMY_BINARY_DIR + "/octotomy verify --self --json",
      folder_ / "");
  EXPECT_EQ(spoiled.status, 1) << spoiled.out;
  EXPECT_TRUE(tests::SortedJson::parse(spoiled.out)["decoder_is_confined"].is_null());
  std::map<std::string, std::string> troubles;
  const tests::SortedJson told = tests::SortedJson::parse(spoiled.out)["parts"];
  for (const tests::SortedJson& part : told)
    troubles[part["part"]] = part["trouble"].is_null() ? "" : part["trouble"].get<std::string>();
  EXPECT_NE(troubles["octotomy-tetgen"].find("another build"), std::string::npos);
  EXPECT_NE(troubles["octotomy-mesh3"].find("no mark"), std::string::npos);
  EXPECT_NE(troubles["octotomy_dicom_codec"].find("missing"), std::string::npos);
  EXPECT_EQ(troubles["octotomy_image_io.so"], "");
}

TEST_F(Verify, OneTierOfRandomQuestionsCanBeAskedAlone) {
  const auto answer = run("verify --random 50 --tier as_given --seed 3 --json");
  EXPECT_EQ(answer.status, 0) << answer.errors;
  const tests::SortedJson json = tests::SortedJson::parse(answer.out);
  EXPECT_EQ(json["as_given"]["asked"], 50);
  EXPECT_EQ(json["as_given"]["verdicts"]["FAIL"], 0);
  EXPECT_EQ(json["exact"]["asked"], 0);
  EXPECT_EQ(json["bounded"]["asked"], 0);
  expect_refused(run("verify --random 5 --tier all"), "--tier");
}

TEST_F(Verify, TheThesissTablesAgree) {
  const auto answer = run("verify --thesis --json");
  EXPECT_EQ(answer.status, 0) << answer.errors;
  const tests::SortedJson json = tests::SortedJson::parse(answer.out);
  EXPECT_GT(json["tables"].size(), 70U);
  EXPECT_GT(json["not_recomputed"].size(), 0U);
}

TEST_F(Verify, TwoMeshesAndTwoLabelMapsOfAnyProgram) {
  for (const char* operation : {"union", "intersection", "difference"}) {
    const auto maps = run("verify " + at("a.nrrd") + " " + operation + " " + at("b.nrrd") + " --json");
    EXPECT_EQ(maps.status, 0) << maps.errors << maps.out;
    const tests::SortedJson json = tests::SortedJson::parse(maps.out);
    EXPECT_EQ(json["certificates"][0]["tier"], "exact");
    // The sets as they were given, where the mesh kernel has an answer, and in general position, smaller.
    EXPECT_EQ(json["counts"]["PASS"], json["certificates"].size());
    EXPECT_GE(json["volume_mm3"], json["certificates"].back()["voxel"]["volume_mm3"]);
  }
  const auto meshes =
      run("verify " + at("a.ply") + " union " + at("b.ply") + " --voxel 0.7 --json --report " + at("page"));
  EXPECT_EQ(meshes.status, 0) << meshes.errors << meshes.out;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "page" / "report.html"));
  std::ifstream written(folder_ / "page" / "result.json");
  EXPECT_EQ(tests::SortedJson::parse(written)["counts"], tests::SortedJson::parse(meshes.out)["counts"]);
}

/// Two boxes whose faces coincide, and the sets that their Booleans are.
class VerifyTouchingBoxes : public tests::CommandLine {
 protected:
  using Box = std::pair<glm::ivec3, glm::ivec3>;
  VerifyTouchingBoxes() {
    universe_.depth = 4;
    a_ = box({2, 2, 2}, {9, 7, 11});
    b_ = box({10, 2, 4}, {13, 7, 11}) | box({6, 6, 6}, {9, 9, 8});
    write("a.nrrd", a_);
    write("b.nrrd", b_);
    write("union.nrrd", a_ | b_);
    write("difference.nrrd", a_ - b_);
    write("spoiled.nrrd", (a_ | b_) - box({12, 4, 6}, {12, 4, 6}));
  }
  voxel::Expression box(const glm::ivec3& first, const glm::ivec3& last) const {
    const voxel::Lattice lattice = universe_.lattice();
    return voxel::Box{lattice.lps_mm(glm::dvec3(first) - 0.5), lattice.lps_mm(glm::dvec3(last) + 0.5)};
  }
  void write(const std::string& name, const voxel::Expression& set) const {
    const voxel::Octree octree = voxel::combine(universe_, set);
    voxel::write_scene(voxel::label_map(universe_.lattice(), {&octree, 1}).scene, folder_ / name);
  }

  voxel::Universe universe_;
  voxel::Expression a_ = voxel::Sphere{}, b_ = voxel::Sphere{};
};

TEST_F(VerifyTouchingBoxes, AreTestedAsTheyAreWithTheirSharedFaces) {
  const auto answer = run("verify " + at("a.nrrd") + " union " + at("b.nrrd") + " --json");
  ASSERT_EQ(answer.status, 0) << answer.errors << answer.out;
  const tests::SortedJson json = tests::SortedJson::parse(answer.out);
  EXPECT_EQ(json["volume_mm3"], 696.0);
  EXPECT_EQ(json["certificates"][0]["mesh"]["volume_mm3"], 696.0);
}

TEST_F(VerifyTouchingBoxes, OctreesAndLabelMapsOnOneLatticeAreOperandsInAnyOrder) {
  voxel::write_octree({voxel::combine(universe_, a_), "a", "{}"}, folder_ / "a.octree");
  voxel::write_octree({voxel::combine(universe_, b_), "b", "{}"}, folder_ / "b.octree");
  voxel::write_octree({voxel::combine(universe_, a_ | b_), "c", "{}"}, folder_ / "union.octree");
  voxel::write_scene(voxel::crop(voxel::read_scene(folder_ / "b.nrrd"), {{5, 1, 3}, {14, 10, 12}}),
                     folder_ / "b_part.nrrd");
  for (const auto& [first, second] : {std::pair{"a.octree", "b.octree"},
                                      {"a.nrrd", "b.octree"},
                                      {"a.octree", "b.nrrd"},
                                      {"a.octree", "b_part.nrrd"},
                                      {"b_part.nrrd", "a.octree"}}) {
    const auto answer =
        run("verify " + at(first) + " union " + at(second) + " --answer " + at("union.octree") + " --json");
    ASSERT_EQ(answer.status, 0) << first << " " << second << answer.errors << answer.out;
    EXPECT_EQ(tests::SortedJson::parse(answer.out)["volume_mm3"], 696.0) << first << " " << second;
  }
}

TEST_F(VerifyTouchingBoxes, AnAnswerOfAnybodyIsJudgedAgainstBothKernels) {
  const auto right =
      run("verify " + at("a.nrrd") + " union " + at("b.nrrd") + " --answer " + at("union.nrrd") + " --json");
  EXPECT_EQ(right.status, 0) << right.errors << right.out;
  const tests::SortedJson json = tests::SortedJson::parse(right.out);
  ASSERT_EQ(json["certificates"].size(), 4U);
  EXPECT_EQ(json["counts"]["PASS"], 4);
  const auto wrong = run("verify " + at("a.nrrd") + " union " + at("b.nrrd") + " --answer " +
                         at("spoiled.nrrd") + " --json");
  EXPECT_EQ(wrong.status, 1);
  // A single voxel; the kernels themselves agree.
  const tests::SortedJson spoiled = tests::SortedJson::parse(wrong.out);
  EXPECT_EQ(spoiled["certificates"][0]["verdict"], "PASS");
  EXPECT_EQ(spoiled["certificates"][2]["verdict"], "FAIL");
  EXPECT_EQ(spoiled["certificates"][3]["verdict"], "FAIL");
}

TEST_F(VerifyTouchingBoxes, AnAnswerOnAPartOrWithTurnedAxesIsLaidOnTheOperands) {
  const voxel::Octree right = voxel::combine(universe_, a_ | b_);
  const voxel::Scene whole = voxel::label_map(universe_.lattice(), {&right, 1}).scene;
  voxel::write_scene(voxel::crop(whole, {{1, 1, 1}, {14, 10, 12}}), folder_ / "part.nrrd");
  voxel::Scene turned = whole;
  const int last = whole.lattice.dims.x - 1;
  turned.lattice.lps_from_voxel[0] *= -1.0;
  turned.lattice.lps_from_voxel[3] = glm::dvec4(whole.lattice.lps_mm({last, 0, 0}), 1.0);
  std::visit(
      [&](auto& samples) {
        for (auto row = samples.begin(); row != samples.end(); row += last + 1)
          std::reverse(row, row + last + 1);
      },
      turned.samples);
  voxel::write_scene(turned, folder_ / "turned.nrrd");
  voxel::Scene between = whole;
  between.lattice.lps_from_voxel[3].x += 0.5;
  voxel::write_scene(between, folder_ / "between.nrrd");
  const std::string question = "verify " + at("a.nrrd") + " union " + at("b.nrrd") + " --json --answer ";
  for (const char* name : {"part.nrrd", "turned.nrrd"}) {
    const auto answer = run(question + at(name));
    EXPECT_EQ(answer.status, 0) << name << answer.errors;
    EXPECT_EQ(tests::SortedJson::parse(answer.out)["counts"]["PASS"], 4) << name;
  }
  EXPECT_EQ(run(question + at("between.nrrd")).status, 2);
}

TEST_F(VerifyTouchingBoxes, AFolderOfTriplesIsJudgedInOneRunWithATable) {
  std::filesystem::create_directory(folder_ / "triples");
  std::filesystem::create_directory(folder_ / "triples" / "first");
  for (const char* file : {"a.nrrd", "b.nrrd", "union.nrrd", "difference.nrrd"})
    std::filesystem::copy_file(folder_ / file, folder_ / "triples" / "first" / file);
  std::ofstream(folder_ / "triples" / "second.json")
      << R"([{"operands": ["../a.nrrd", "../b.nrrd"], "operation": "union", "result": "../spoiled.nrrd"}])";
  const auto answer = run("verify " + at("triples") + " --json");
  EXPECT_EQ(answer.status, 1) << answer.errors;
  const tests::SortedJson questions = tests::SortedJson::parse(answer.out)["questions"];
  ASSERT_EQ(questions.size(), 3U);
  EXPECT_EQ(questions[0]["verdict"], "PASS");
  EXPECT_EQ(questions[1]["verdict"], "PASS");
  EXPECT_EQ(questions[2]["verdict"], "FAIL");
  EXPECT_EQ(questions[2]["answer_mm3"], 695.0);
  std::ofstream(folder_ / "triples" / "third.json") << R"({"operands": ["a"], "operation": "union"})";
  expect_refused(run("verify " + at("triples")), "two paths");
}

TEST_F(Verify, AMeshIsJudgedAgainstBothKernelsAndASpoiledOneFails) {
  const std::string question = "verify " + at("a.ply") + " union " + at("b.ply") + " --voxel 0.7 --answer ";
  ASSERT_EQ(run("boolean " + at("a.ply") + " union " + at("b.ply") + " -o " + at("c.ply")).status, 0);
  const auto right = run(question + at("c.ply") + " --json");
  EXPECT_EQ(right.status, 0) << right.errors << right.out;
  EXPECT_EQ(tests::SortedJson::parse(right.out)["certificates"].size(), 3U);
  const auto wrong = run(question + at("a.ply") + " --json");
  EXPECT_EQ(wrong.status, 1) << wrong.out;
  EXPECT_GE(tests::SortedJson::parse(wrong.out)["counts"]["FAIL"], 2);
}

TEST_F(Verify, AVoxelThatHoldsBothMeshesIsNoEvidenceAndNoSuccess) {
  const std::string question = "verify " + at("a.ply") + " difference " + at("b.ply") + " --voxel 40 --json";
  const auto answer = run(question);
  EXPECT_EQ(answer.status, 1) << answer.out;
  const tests::SortedJson json = tests::SortedJson::parse(answer.out);
  EXPECT_EQ(json["certificates"][0]["resolved"], false);
  EXPECT_EQ(json["counts"]["without_evidence"], 1);
  EXPECT_EQ(run(question + " --accept-unresolved").status, 0);
}

TEST_F(Verify, AMeshAndALabelMapAreBroughtToBothKernels) {
  for (const std::string& question :
       {at("a.ply") + " union " + at("b.nrrd"), at("b.nrrd") + " difference " + at("a.ply")}) {
    const auto answer = run("verify " + question + " --accept-unresolved --json");
    EXPECT_EQ(answer.errors.find("not one of each"), std::string::npos) << answer.errors;
    const tests::SortedJson json = tests::SortedJson::parse(answer.out);
    EXPECT_EQ(json["certificates"].size(), 1U) << question;
    EXPECT_NE(json["certificates"][0]["operation"].get<std::string>().find("boundary of its voxels"),
              std::string::npos);
    EXPECT_EQ(json["counts"]["FAIL"], 0) << answer.out;
  }
}

TEST_F(Verify, WhatCannotBeUnderstoodIsRefusedByName) {
  expect_refused(run("verify " + at("a.ply") + " minus " + at("b.ply")), "minus");
  expect_refused(run("verify " + at("a.ply") + " union " + at("none.ply")), "none.ply");
  expect_refused(run("verify --seed 3"), "--random");
  expect_refused(run("verify " + at("a.nrrd") + " union " + at("b.nrrd") + " --voxel 1"), "--voxel");
  expect_refused(run("verify --random 2 --thesis"), "give only one");
}

}  // namespace
}  // namespace octotomy::planner
