// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What keeps a certificate from a PASS however well both kernels agree: parts that left the universe, samples
// that are no numbers, answers that one piece of code made.
#include <fstream>
#include <gtest/gtest.h>
#include <limits>

#include "planner/operation/table/json.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/ball_scan.h"

namespace octotomy::planner {
namespace {

using verify::Verdict;

class Caveats : public testing::Test {
 protected:
  Caveats() {
    voxel::write_scene(tests::ball_scene(20.0), folder_ / "ball.nrrd");
    plan_ = {{"octotomy_plan", 1},
             {"name", "ball"},
             {"scans", {{"ct", {{"path", "ball.nrrd"}}}}},
             {"steps", SortedJson::array()}};
    add({{"id", "ball"}, {"do", "window"}, {"scan", "ct"}, {"low", 0}});
    const SortedJson cap{{-40, 5.3}, {40, 5.3}, {40, 40}, {-40, 40}};
    add({{"id", "top"},
         {"do", "mask"},
         {"regions", {{{"view", "anterior"}, {"polygons_mm", SortedJson::array({cap})}}}}});
  }
  void add(const SortedJson& step) { plan_["steps"].push_back(step); }
  /// Writes the ball's scan with samples that are no finite numbers.
  void write_without_numbers(const std::vector<glm::ivec3>& places) {
    voxel::Scene scene = tests::ball_scene(20.0);
    const auto& numbers = std::get<voxel::Int16Samples>(scene.samples);
    voxel::FloatSamples samples(numbers.begin(), numbers.end());
    float none = std::numeric_limits<float>::quiet_NaN();
    for (const glm::ivec3& at : places) {
      samples[static_cast<std::size_t>((at.z * 64 + at.y) * 64 + at.x)] = none;
      none = std::numeric_limits<float>::infinity();
    }
    scene.samples = std::move(samples);
    voxel::write_scene(scene, folder_ / "ball.nrrd");
  }
  Evaluation evaluated() const { return evaluate(parse_plan(plan_.dump(), folder_.path())); }
  static std::string reasons(const Object& object) { return SortedJson(object.certificate->reasons).dump(); }

  tests::ScratchFolder folder_;
  SortedJson plan_;
};

TEST_F(Caveats, AMeshBeyondAllRoomFailsAndSaysHowMuchLies) {
  std::ofstream(folder_ / "box.off")
      << ("OFF\n8 12 0\n10 -5 -5\n620 -5 -5\n620 5 -5\n10 5 -5\n10 -5 5\n620 -5 5\n620 5 5\n10 5 5\n"
          "3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 2 3 7\n3 2 7 6\n3 1 2 6\n3 1 6 5\n"
          "3 0 4 7\n3 0 7 3\n");
  add({{"id", "box"}, {"do", "import"}, {"path", "box.off"}});
  add({{"id", "joined"}, {"do", "combine"}, {"expression", "ball | box"}});
  const Evaluation evaluation = evaluated();
  const Object& joined = evaluation.object("joined");
  ASSERT_TRUE(joined.certificate);
  EXPECT_EQ(joined.certificate->verdict, Verdict::Fail);
  EXPECT_NE(reasons(joined).find("outside of the universe"), std::string::npos) << reasons(joined);
}

TEST_F(Caveats, APartThatLeavesTheScanIsWholeInEveryObjectMadeOfIt) {
  const auto move = [&](const char* id, const char* object, double by_mm) {
    add({{"id", id}, {"do", "move"}, {"object", object}, {"translate_mm", {0, by_mm, 0}}});
  };
  move("a_little", "ball", -15.0);
  move("half", "ball", -32.0);
  move("out", "ball", 45.0);
  add({{"id", "joined"}, {"do", "combine"}, {"expression", "ball | out"}});
  move("moved_on", "joined", 40.0);
  move("back", "out", -45.0);
  const Evaluation evaluation = evaluated();
  const double ball_mm3 = evaluation.object("ball").voxel.measures.volume_mm3;
  for (const char* id : {"a_little", "half", "out", "joined", "moved_on", "back"}) {
    const Object& object = evaluation.object(id);
    ASSERT_TRUE(object.certificate) << id;
    EXPECT_EQ(object.certificate->verdict, Verdict::Pass) << id << reasons(object);
    const double whole_mm3 =
        id == std::string("joined") || id == std::string("moved_on") ? 2.0 * ball_mm3 : ball_mm3;
    EXPECT_EQ(object.voxel.measures.volume_mm3, whole_mm3) << id;
  }
  EXPECT_TRUE(evaluation.object("back").voxel.octree == evaluation.object("ball").voxel.octree);
}

// The mesh kernel alone decimates. A motion reads the digitised voxels, which lie up to half a voxel's diagonal
// from the surface.
TEST_F(Caveats, ADecimatedSurfaceIsSharedAndNotContradictedThroughMotionsAndBooleans) {
  const SortedJson turn{{"degrees", 7}, {"axis", {1, 2, 0}}, {"about_mm", {0, 3, 0}}};
  const auto move = [&](const char* id, const char* object) {
    add({{"id", id}, {"do", "move"}, {"object", object}, {"translate_mm", {2, 1, 0}}, {"rotate", turn}});
  };
  add({{"id", "fewer"}, {"do", "decimate"}, {"object", "ball"}, {"faces", 800}});
  move("moved", "fewer");
  move("again", "moved");
  add({{"id", "part"}, {"do", "combine"}, {"expression", "fewer & top"}});
  move("moved_part", "part");
  add({{"id", "both"}, {"do", "combine"}, {"expression", "(moved_part | ball) - (ball - top)"}});
  const Evaluation evaluation = evaluated();
  for (const char* id : {"fewer", "moved", "again", "part", "moved_part", "both"})
    EXPECT_EQ(evaluation.object(id).certificate->verdict, Verdict::Warn)
        << id << reasons(evaluation.object(id));
}

TEST_F(Caveats, AnEmptyObjectProvesNothing) {
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  add({{"id", "away"}, {"do", "combine"}, {"expression", "cap - ball"}});
  const Evaluation evaluation = evaluated();
  const Object& away = evaluation.object("away");
  EXPECT_EQ(away.certificate->verdict, Verdict::Warn);
  EXPECT_FALSE(away.certificate->resolved());
  EXPECT_NE(reasons(away).find("could have been missed"), std::string::npos) << reasons(away);
}

TEST_F(Caveats, AnObjectWithoutItselfIsSurelyEmpty) {
  add({{"id", "turned"},
       {"do", "move"},
       {"object", "ball"},
       {"rotate", {{"degrees", 30}, {"axis", {0.3, 1, 0.2}}}}});
  const std::vector<std::pair<const char*, const char*>> empty{
      {"none", "ball - ball"}, {"neither", "turned ^ turned"}, {"nowhere", "(ball & top) - ball"}};
  for (const auto& [id, expression] : empty) {
    add({{"id", id}, {"do", "combine"}, {"expression", expression}});
    add({{"id", std::string("size_") + id}, {"do", "measure"}, {"object", id}});
  }
  add({{"id", "all"}, {"do", "combine"}, {"expression", "ball & ball | top & ~top"}});
  const Plan plan = parse_plan(plan_.dump(), folder_.path());
  const Evaluation evaluation = evaluate(plan);
  for (const auto& [id, expression] : empty) {
    EXPECT_EQ(evaluation.object(id).certificate->verdict, Verdict::Pass)
        << id << reasons(evaluation.object(id));
    EXPECT_TRUE(evaluation.object(id).certificate->resolved()) << id;
    EXPECT_TRUE(verify::is_evident(*evaluation.object(id).certificate)) << id;
  }
  EXPECT_FALSE(evaluation.object("all").is_surely_empty);
  for (const Json& size : measurements_json(plan, evaluation)) {
    EXPECT_EQ(size.at("volume").at("value"), 0.0) << size;
    EXPECT_EQ(size.at("volume").at("half_width"), 0.0) << size;
    EXPECT_FALSE(size.contains("finding")) << size;
  }
}

TEST_F(Caveats, AnObjectThatTheScansBorderCutsOffSaysSo) {
  add({{"id", "bone"}, {"do", "segment"}, {"scan", "ct"}, {"window", "0:"}});
  // Seeds choose voxels, so that there is no mesh.
  add({{"id", "grown"},
       {"do", "segment"},
       {"scan", "ct"},
       {"window", "0:"},
       {"seeds_mm", SortedJson::array({{0.5, 0.5, 0.5}})}});
  add({{"id", "moved"}, {"do", "move"}, {"object", "bone"}, {"translate_mm", {1, 2, 0}}});
  for (const Object& whole : evaluated().objects) EXPECT_FALSE(whole.border_finding) << whole.id;
  // Each of the six sides, 18 mm from the centre, cuts a disc of 238.8 mm2.
  voxel::write_scene(tests::ball_scene(20.0, 36), folder_ / "ball.nrrd");
  const Evaluation evaluation = evaluated();
  for (const char* id : {"ball", "bone", "grown"}) {
    const Object& object = evaluation.object(id);
    ASSERT_TRUE(object.border_finding) << id;
    EXPECT_NE(object.border_finding->find("the scan's border cuts off the object over an area of 1"),
              std::string::npos)
        << *object.border_finding;
    EXPECT_EQ(object.findings.back(), *object.border_finding) << id;
  }
  EXPECT_EQ(evaluation.object("moved").border_finding, evaluation.object("bone").border_finding);
}

TEST_F(Caveats, SamplesThatAreNoNumbersAreCountedAndForbidAPass) {
  write_without_numbers({{2, 2, 2}, {3, 2, 2}});
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  const Evaluation evaluation = evaluated();
  for (const char* id : {"ball", "cap"}) {
    EXPECT_EQ(evaluation.object(id).certificate->verdict, Verdict::Warn) << id;
    EXPECT_NE(reasons(evaluation.object(id)).find("2 samples"), std::string::npos)
        << reasons(evaluation.object(id));
  }
}

TEST_F(Caveats, SamplesThatAreNoNumbersAmongAnObjectsOwnAreAHoleInIt) {
  std::vector<glm::ivec3> block;
  for (int z = 40; z < 44; ++z)
    for (int y = 30; y < 33; ++y)
      for (int x = 30; x < 36; ++x) block.emplace_back(x, y, z);
  write_without_numbers(block);
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  const Evaluation evaluation = evaluated();
  EXPECT_EQ(evaluation.object("ball").certificate->verdict, Verdict::Fail);
  EXPECT_NE(reasons(evaluation.object("ball")).find("72.0 mm3 of it are missing"), std::string::npos)
      << reasons(evaluation.object("ball"));
  EXPECT_NE(evaluation.object("cap").certificate->verdict, Verdict::Pass);
}

TEST_F(Caveats, ASliceOfPaddingThroughAnObjectIsAHoleInItAndPaddingBesideItIsNone) {
  for (const bool is_through : {true, false}) {
    voxel::Scene scene = tests::ball_scene(20.0);
    auto& samples = std::get<voxel::Int16Samples>(scene.samples);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        for (int z = is_through ? 30 : 0; z < (is_through ? 31 : 3); ++z)
          samples[static_cast<std::size_t>((z * 64 + y) * 64 + x)] = -3024;
    scene.padding = -3024.0;
    voxel::write_scene(scene, folder_ / "ball.nrrd");
    const Evaluation evaluation = evaluated();
    const Object& ball = evaluation.object("ball");
    EXPECT_EQ(ball.certificate->verdict, is_through ? Verdict::Fail : Verdict::Pass) << reasons(ball);
    EXPECT_EQ(reasons(ball).find("are padding") != std::string::npos, is_through) << reasons(ball);
  }
}

/// A dark sample within a ball of 33,000 mm3 has the padding's value: it is stated, and the ball passes. In a piece around
/// it that has a few hundred cubic millimetres, one sample matters; in a piece beside it, it does not.
TEST_F(Caveats, PaddingOfLittleVolumeIsStatedAndCountsInSmallPieces) {
  voxel::Scene scene = tests::ball_scene(20.0);
  std::get<voxel::Int16Samples>(scene.samples)[(32 * 64 + 32) * 64 + 32] = -3024;
  scene.padding = -3024.0;
  voxel::write_scene(scene, folder_ / "ball.nrrd");
  const SortedJson square = SortedJson::array({{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}}});
  add({{"id", "cube"},
       {"do", "mask"},
       {"regions",
        {{{"view", "anterior"}, {"polygons_mm", square}}, {{"view", "left"}, {"polygons_mm", square}}}}});
  add({{"id", "core"}, {"do", "combine"}, {"expression", "ball & cube"}});
  add({{"id", "moved"}, {"do", "move"}, {"object", "core"}, {"translate_mm", {3, 0, 0}}});
  const SortedJson beside = SortedJson::array({{{6, 6}, {12, 6}, {12, 12}, {6, 12}}});
  add({{"id", "post"}, {"do", "mask"}, {"regions", {{{"view", "anterior"}, {"polygons_mm", beside}}}}});
  add({{"id", "side"}, {"do", "combine"}, {"expression", "ball & post"}});
  const Evaluation evaluation = evaluated();
  const Object& ball = evaluation.object("ball");
  EXPECT_EQ(ball.certificate->verdict, Verdict::Pass) << reasons(ball);
  for (const char* id : {"core", "moved"}) {
    const Object& around = evaluation.object(id);
    EXPECT_EQ(around.certificate->verdict, Verdict::Warn) << id << around.voxel.measures.volume_mm3;
    EXPECT_NE(reasons(around).find("are padding"), std::string::npos) << id << reasons(around);
  }
  EXPECT_EQ(reasons(evaluation.object("side")).find("are padding"), std::string::npos);
  EXPECT_TRUE(std::any_of(ball.findings.begin(), ball.findings.end(), [](const std::string& finding) {
    return finding.find("lie between samples of this object") != std::string::npos;
  }));
}

/// A motion leaves a hole of 5 mm through the ball: no tissue is missing there, also in scans made of the
/// operated one.
TEST_F(Caveats, HolesThatAMotionLeftAreNoMissingTissue) {
  add({{"id", "cap"}, {"do", "combine"}, {"expression", "ball & top"}});
  add({{"id", "raised"}, {"do", "move"}, {"object", "cap"}, {"translate_mm", {0, 0, 5}}});
  add({{"id", "operated"}, {"do", "scan_of"}, {"scan", "ct"}, {"expression", "raised | (ball - top)"}});
  add({{"id", "part"},
       {"do", "crop"},
       {"scan", "operated"},
       {"low_mm", {-30, -30, -30}},
       {"high_mm", {30, 30, 30}}});
  add({{"id", "seen"}, {"do", "window"}, {"scan", "operated"}, {"low", 0}});
  add({{"id", "seen_in_part"}, {"do", "window"}, {"scan", "part"}, {"low", 0}});
  const Evaluation evaluation = evaluated();
  for (const char* name : {"seen", "seen_in_part"}) {
    const Object& seen = evaluation.object(name);
    EXPECT_EQ(seen.certificate->verdict, Verdict::Warn) << reasons(seen);
    EXPECT_NE(reasons(seen).find("are holes that no object fills"), std::string::npos) << reasons(seen);
    EXPECT_NE(reasons(seen).find("a 'hole_value' of the step 'scan_of' fills them"), std::string::npos);
    EXPECT_EQ(reasons(seen).find("missing"), std::string::npos) << reasons(seen);
  }
}

/// Copied samples, too, have voxels that no scanner measured.
TEST_F(Caveats, SamplesThatAreNoNumbersAreKnownInScansThatStepsMake) {
  write_without_numbers({{2, 2, 2}});
  plan_["steps"] = SortedJson::array();
  add({{"id", "part"},
       {"do", "crop"},
       {"scan", "ct"},
       {"low_mm", {-30, -30, -30}},
       {"high_mm", {30, 30, 30}}});
  add({{"id", "ball"}, {"do", "window"}, {"scan", "part"}, {"low", 0}});
  const Evaluation evaluation = evaluated();
  EXPECT_NE(evaluation.object("ball").certificate->verdict, Verdict::Pass);
}

TEST_F(Caveats, WhatOnlyTheMeshKernelDoesStaysSoThroughBooleansAndMotions) {
  add({{"id", "even"}, {"do", "smooth"}, {"object", "ball"}, {"rounds", 5}});
  add({{"id", "grown"}, {"do", "offset"}, {"object", "even"}, {"by_mm", 2}});
  add({{"id", "part"}, {"do", "combine"}, {"expression", "grown & top"}});
  add({{"id", "moved"}, {"do", "move"}, {"object", "part"}, {"translate_mm", {1, 0, 0}}});
  add({{"id", "rest"}, {"do", "combine"}, {"expression", "ball - moved"}});
  add({{"id", "clean"}, {"do", "combine"}, {"expression", "ball & top"}});
  const Evaluation evaluation = evaluated();
  for (const char* id : {"even", "grown", "part", "moved", "rest"}) {
    const verify::Certificate& certificate = *evaluation.object(id).certificate;
    EXPECT_FALSE(certificate.independent()) << id;
    EXPECT_NE(certificate.verdict, Verdict::Pass) << id;
    EXPECT_NE(reasons(evaluation.object(id)).find("not independent, as the same code made both: smooth"),
              std::string::npos)
        << reasons(evaluation.object(id));
  }
  const verify::Certificate& clean = *evaluation.object("clean").certificate;
  EXPECT_TRUE(clean.independent());
  EXPECT_EQ(clean.verdict, Verdict::Pass) << reasons(evaluation.object("clean"));
  // The makers begin with the operands: the window's and the Boolean's code of each kernel.
  EXPECT_GE(clean.voxel.makers.size(), 3U);
  EXPECT_GE(clean.mesh.makers.size(), 3U);
}

TEST_F(Caveats, AValueThatAStepFindsForBothKernelsIsTold) {
  add({{"id", "bright"}, {"do", "segment"}, {"scan", "ct"}, {"otsu", 2}});
  add({{"id", "part"}, {"do", "combine"}, {"expression", "bright & top"}});
  const Evaluation evaluation = evaluated();
  ASSERT_EQ(evaluation.object("part").certificate->shared_values.size(), 1U);
  EXPECT_EQ(evaluation.object("part").certificate->shared_values.front().rfind("segment", 0), 0U);
  EXPECT_TRUE(evaluation.object("ball").certificate->shared_values.empty());
}

}  // namespace
}  // namespace octotomy::planner
