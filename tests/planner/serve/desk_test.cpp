// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/serve/desk.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

class DeskTest : public testing::Test {
 protected:
  DeskTest() { voxel::write_scene(tests::ball_scene(8.0, 24), folder_ / "ball.nrrd"); }

  void add(const Json& step) {
    desk_->with_document([&](Document& document) { document.edit({{"add", {{"step", step}}}}); });
  }

  tests::ScratchFolder kept_;
  fs::path folder_ = fs::canonical(kept_.path());
  std::unique_ptr<Desk> desk_ = std::make_unique<Desk>(folder_);
};

TEST_F(DeskTest, AScanBeginsAPlanOfItsBoneInTheWorkingFolder) {
  EXPECT_TRUE(desk_->state().is_null());
  EXPECT_THROW(desk_->with_document([](Document&) {}), voxel::Error);
  desk_->open(folder_ / "ball.nrrd", {});
  const Json state = desk_->state();
  EXPECT_EQ(state["path"], (folder_ / "ball.plan.json").string());
  EXPECT_EQ(state["scans"][0]["bounds_mm"], Json::parse("[[-12.0,-12.0,-12.0],[12.0,12.0,12.0]]"));
  EXPECT_FALSE(state["objects"][0]["evaluated"]);
  desk_->evaluate({}, false, {});
  EXPECT_TRUE(desk_->state()["objects"][0]["evaluated"]);
  EXPECT_EQ(desk_->snapshot().evaluation->loaded.size(), 1u) << "slices need the samples";
}

TEST_F(DeskTest, APlanOfAnotherScanIsLeftAlone) {
  std::ofstream(folder_ / "ball.plan.json") << "{}";
  desk_->open(folder_ / "ball.nrrd", {});
  EXPECT_EQ(desk_->state()["path"], (folder_ / "ball-2.plan.json").string());
}

TEST_F(DeskTest, AStepThatFailsTakesOnlyThoseThatNeedItAlong) {
  desk_->open(folder_ / "ball.nrrd", {});
  add({{"id", "lost"}, {"do", "import"}, {"path", "nowhere.stl"}});
  add({{"id", "more"}, {"do", "combine"}, {"expression", "bone | lost"}});
  add({{"id", "same"}, {"do", "combine"}, {"expression", "bone & bone"}});
  const Snapshot made = desk_->evaluate({}, false, {});
  EXPECT_EQ(made.evaluation->objects.size(), 2u);
  ASSERT_EQ(made.errors.size(), 1u);
  EXPECT_EQ(made.errors.begin()->first, "lost");
  const Json state = desk_->state();
  for (const Json& object : state["objects"])
    EXPECT_EQ(object.contains("error"), object["id"] == "lost") << object;
}

TEST_F(DeskTest, APreviewIsTheMoveStepsObject) {
  desk_->open(folder_ / "ball.nrrd", {});
  desk_->evaluate({}, false, {});
  const Json move{{"translate_mm", {2, 0, 0}}};
  const Desk::Preview preview = desk_->preview("bone", move, {"bone"}, {});
  add({{"id", "moved"}, {"do", "move"}, {"object", "bone"}, {"translate_mm", {2, 0, 0}}});
  const Snapshot made = desk_->evaluate({}, false, {});
  EXPECT_TRUE(preview.evaluation->object(Desk::Preview::moved).voxel.octree ==
              made.evaluation->object("moved").voxel.octree);
  EXPECT_EQ(desk_->state()["plan"]["steps"].size(), 2u) << "a preview is no step";
  const Desk::Preview again = desk_->preview("bone", move, {}, {});
  EXPECT_EQ(again.evaluation->objects.size(), 2u) << "no overlap was asked for";
}

TEST_F(DeskTest, ACertificateIsOfTheStepAsItWas) {
  desk_->open(folder_ / "ball.nrrd", {});
  desk_->evaluate({}, true, {});
  const Json bone = desk_->state()["objects"][0];
  EXPECT_EQ(bone["certificate"]["verdict"], "PASS") << bone;
  EXPECT_GT(bone["volume"]["half_width"], 0.0);
  desk_->with_document([&](Document& document) {
    Json step = document.json()["steps"][0];
    step["low"] = 500;
    document.edit({{"replace", {{"id", "bone"}, {"step", step}}}});
  });
  desk_->evaluate({}, false, {});
  EXPECT_FALSE(desk_->state()["objects"][0].contains("certificate"));
  desk_->with_document([](Document& document) { document.undo(); });
  EXPECT_TRUE(desk_->state()["objects"][0].contains("certificate"));
}

TEST_F(DeskTest, AStoppedEvaluationChangesNothing) {
  desk_->open(folder_ / "ball.nrrd", {});
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(desk_->evaluate({}, false, {stop.get_token(), {}}), Stopped);
  EXPECT_FALSE(desk_->state()["objects"][0]["evaluated"]);
}

}  // namespace
}  // namespace octotomy::planner::serve
