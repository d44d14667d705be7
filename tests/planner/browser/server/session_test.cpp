// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/session.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>
#include <thread>

#include "planner/browser/server/new_plan.h"
#include "planner/browser/server/requests.h"
#include "planner/result/report/first_look.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "voxel/scan/read_scene.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

namespace fs = std::filesystem;

class SessionTest : public testing::Test {
 protected:
  SessionTest() { voxel::write_scene(tests::ball_scene(8.0, 24), folder_ / "ball.nrrd"); }

  void add(const Json& step) {
    session_->with_document([&](Document& document) { document.edit({{"add", {{"step", step}}}}); });
  }

  tests::ScratchFolder kept_;
  fs::path folder_ = fs::canonical(kept_.path());
  std::unique_ptr<Session> session_ = std::make_unique<Session>(folder_);
};

TEST_F(SessionTest, AScanBeginsAPlanOfItsBoneInTheWorkingFolder) {
  EXPECT_TRUE(session_->state().is_null());
  EXPECT_THROW(session_->with_document([](Document&) {}), voxel::Error);
  session_->open(folder_ / "ball.nrrd", {});
  const Json state = session_->state();
  EXPECT_EQ(state["path"], (folder_ / "ball.plan.json").string());
  EXPECT_EQ(state["scans"][0]["bounds_mm"], Json::parse("[[-12.0,-12.0,-12.0],[12.0,12.0,12.0]]"));
  EXPECT_FALSE(state["objects"][0]["evaluated"]);
  session_->evaluate({}, false, {});
  EXPECT_TRUE(session_->state()["objects"][0]["evaluated"]);
  EXPECT_EQ(session_->snapshot().evaluation->loaded.size(), 1u) << "slices need the samples";
}

TEST(Requests, AWindowThatOnlyLooksMayRequestTheseAndNoneThatChangesThePlan) {
  std::vector<std::string> open;
  for (const RequestKind& request_kind : request_kinds()) {
    if (!request_kind.may_view) continue;
    open.push_back(request_kind.name);
    EXPECT_FALSE(request_kind.changes_plan) << request_kind.name;
  }
  EXPECT_EQ(open, (std::vector<std::string>{"hello", "diff", "evaluate", "movement", "cephalometry"}));
}

TEST_F(SessionTest, AMergeTakesTheOthersChangesOrNamesWhatBothChanged) {
  session_->open(folder_ / "ball.nrrd", {});
  const fs::path other = folder_ / "other.plan.json", mine = folder_ / "ball.plan.json";
  const auto request = [&](const char* name, const Json& said) {
    return find_request_kind(name).answer(*session_, said, {});
  };
  fs::copy_file(mine, other);
  // Both go on from the same state: one adds a step, the other changes the window.
  Json theirs = Json::parse(tests::bytes_of(other));
  const std::string bone = theirs["steps"][0]["id"];
  theirs["steps"][0]["low"] = 7.0;
  std::ofstream(other) << theirs;
  add({{"id", "twin"}, {"do", "combine"}, {"expression", bone}});
  const Json tried = request("try_merge", {{"path", "other.plan.json"}});
  EXPECT_EQ(tried["base"], 1);
  EXPECT_EQ(tried["conflicts"], Json::array());
  ASSERT_EQ(tried["rows"].size(), 1u) << tried;
  EXPECT_NE(tried["rows"][0].get<std::string>().find("low"), std::string::npos) << tried;
  EXPECT_EQ(session_->state()["edit"], 2) << "a trial changes nothing";
  request("merge", {{"path", "other.plan.json"}});
  EXPECT_EQ(session_->state()["plan"]["steps"].size(), 2u);
  EXPECT_EQ(session_->state()["plan"]["steps"][0]["low"], 7.0);
  EXPECT_EQ(session_->state()["history"][2]["what"], "merged with other");
  // The same value, changed twice.
  Json own = session_->state()["plan"]["steps"][0];
  own["low"] = 9.0;
  session_->with_document([&](Document& document) {
    document.edit({{"replace", {{"id", bone}, {"step", own}}}});
  });
  theirs["steps"][0]["low"] = 8.0;
  std::ofstream(other) << theirs;
  const Json conflicts = request("try_merge", {{"path", "other.plan.json"}, {"base", 3}})["conflicts"];
  ASSERT_EQ(conflicts.size(), 1u) << conflicts;
  EXPECT_EQ(conflicts[0]["field"], "low");
  try {
    request("merge", {{"path", "other.plan.json"}, {"base", 1}});
    FAIL();
  } catch (const voxel::Error& error) {
    EXPECT_NE(std::string(error.what()).find("low"), std::string::npos) << error.what();
  }
  EXPECT_EQ(session_->state()["edit"], 4);
  // The other plan's paths are no permissions.
  theirs["steps"].push_back({{"id", "names"}, {"do", "landmarks"}, {"file", "/etc/passwd"}});
  std::ofstream(other) << theirs;
  for (const char* name : {"try_merge", "merge"}) {
    try {
      request(name, {{"path", "other.plan.json"}});
      FAIL();
    } catch (const std::exception& error) {
      EXPECT_NE(std::string(error.what()).find("no folder that is open"), std::string::npos) << error.what();
    }
    EXPECT_THROW(request(name, {{"path", "/etc/hostname"}}), voxel::Error);
  }
}

TEST_F(SessionTest, ASignatureHoldsUntilThePlanOrItsScanChanges) {
  session_->open(folder_ / "ball.nrrd", {});
  const auto request = [&](const char* name, const Json& said) {
    return find_request_kind(name).answer(*session_, said, {});
  };
  EXPECT_EQ(request("signatures", {})["signatures"], Json::array());
  for (const Json& wrong :
       {Json{{"by", ""}}, Json{{"by", "a\nb"}}, Json{{"by", std::string(300, 'a')}}, Json::object()})
    EXPECT_ANY_THROW(request("sign", wrong)) << wrong;
  EXPECT_EQ(session_->state()["edit"], 1);
  const Json made =
      request("sign", {{"by", "A. Reader"}, {"as", "second reader"}, {"note", "read"}})["signatures"];
  ASSERT_EQ(made.size(), 1u);
  EXPECT_EQ(made[0]["by"], "A. Reader");
  EXPECT_EQ(made[0]["changed_since"], Json::array());
  EXPECT_EQ(session_->state()["history"][1]["what"], "signed by A. Reader");
  add({{"id", "twin"}, {"do", "combine"}, {"expression", session_->state()["plan"]["steps"][0]["id"]}});
  EXPECT_EQ(request("signatures", {})["signatures"][0]["changed_since"], Json::array({"the plan"}));
  voxel::write_scene(tests::ball_scene(7.0, 24), folder_ / "ball.nrrd");
  EXPECT_EQ(request("signatures", {})["signatures"][0]["changed_since"],
            Json::array({"the plan", "scan ct"}));
}

TEST_F(SessionTest, APlanOfAnotherScanIsLeftAlone) {
  std::ofstream(folder_ / "ball.plan.json") << "{}";
  session_->open(folder_ / "ball.nrrd", {});
  EXPECT_EQ(session_->state()["path"], (folder_ / "ball-2.plan.json").string());
}

TEST_F(SessionTest, AStepThatFailsTakesOnlyThoseThatNeedItAlong) {
  session_->open(folder_ / "ball.nrrd", {});
  add({{"id", "lost"}, {"do", "import"}, {"path", "nowhere.stl"}});
  add({{"id", "more"}, {"do", "combine"}, {"expression", "bone | lost"}});
  add({{"id", "same"}, {"do", "combine"}, {"expression", "bone & bone"}});
  const Snapshot made = session_->evaluate({}, false, {});
  EXPECT_EQ(made.evaluation->objects.size(), 2u);
  ASSERT_EQ(made.errors.size(), 1u);
  EXPECT_EQ(made.errors.begin()->first, "lost");
  const Json state = session_->state();
  for (const Json& object : state["objects"])
    EXPECT_EQ(object.contains("error"), object["id"] == "lost") << object;
}

TEST_F(SessionTest, AReportLeavesOutWhatFailedAndSaysSo) {
  session_->open(folder_ / "ball.nrrd", {});
  add({{"id", "lost"}, {"do", "import"}, {"path", "nowhere.stl"}});
  add({{"id", "more"}, {"do", "combine"}, {"expression", "bone | lost"}});
  add({{"id", "more_size"}, {"do", "measure"}, {"object", "more"}});
  add({{"id", "lost_file"}, {"do", "export"}, {"object", "lost"}, {"path", "lost.stl"}});
  add({{"id", "size"}, {"do", "measure"}, {"object", "bone"}});
  add({{"id", "file"}, {"do", "export"}, {"object", "bone"}, {"path", "bone.stl"}});
  const Json made = find_request_kind("report").answer(*session_, Json::object(), {});
  EXPECT_EQ(made["left_out"], Json({"lost", "more", "more_size", "lost_file"}));
  EXPECT_EQ(made["counts"]["PASS"], 1);
  const fs::path folder = made["folder"].get<std::string>();
  EXPECT_TRUE(fs::exists(folder / "bone.stl"));
  const Json result = Json::parse(std::ifstream(folder / "result.json"));
  ASSERT_EQ(result["certificates"].size(), 1U);
  EXPECT_EQ(result["measurements"].size(), 1U);
  int failed = 0;
  for (const Json& finding : result["findings"]) failed += finding["verdict"] == "FAIL" ? 1 : 0;
  EXPECT_EQ(failed, 4) << result["findings"];
  EXPECT_NE(tests::bytes_of(folder / "report.html").find("nowhere.stl"), std::string::npos)
      << "the report says why";
  const Snapshot certified = session_->evaluate({}, true, {});
  EXPECT_TRUE(certified.evaluation->object("bone").certificate.has_value());
}

TEST_F(SessionTest, AMeasurementThatFailsLeavesTheOthersTheirAnswers) {
  session_->open(folder_ / "ball.nrrd", {});
  add({{"id", "wide"}, {"do", "measure"}, {"points_mm", {{-8, 0, 0}, {8, 0, 0}}}});
  add({{"id", "nowhere"},
       {"do", "airway"},
       {"object", "bone"},
       {"begin", {100, 0, 0}},
       {"end", {-100, 0, 0}}});
  const Snapshot made = session_->evaluate({}, true, {});
  ASSERT_EQ(made.errors.count("nowhere"), 1U);
  ASSERT_EQ(made.measurements.size(), 2U);
  EXPECT_EQ(made.measurements[0]["value"], 16.0);
  EXPECT_TRUE(made.measurements[1]["value"].is_null());
  EXPECT_EQ(made.measurements[1]["sentence"], made.errors.at("nowhere"));
}

TEST_F(SessionTest, BoneBeginsInTheScansOwnSamples) {
  session_->open(folder_ / "ball.nrrd", {});
  voxel::Scene ball = voxel::read_scene(folder_ / "ball.nrrd");
  EXPECT_EQ(session_->state()["scans"][0]["bone_low"], bone_low(ball));
  ball.meaning = voxel::Meaning::Hounsfield;
  EXPECT_EQ(bone_low(ball), 300.0);
  ball.meaning = voxel::Meaning::Label;
  EXPECT_EQ(bone_low(ball), 1.0);
  ball.meaning = voxel::Meaning::Raw;
  EXPECT_EQ(bone_low(ball), thresholds_of(ball).upper);
  EXPECT_TRUE(session_->state()["scans"][0]["patient"].is_null());
}

TEST_F(SessionTest, TheLargestPartOfAnOverlapHasAPlace) {
  session_->open(folder_ / "ball.nrrd", {});
  add({{"id", "moved"}, {"do", "move"}, {"object", "bone"}, {"translate_mm", {6, 0, 0}}});
  add({{"id", "both"}, {"do", "combine"}, {"expression", "bone & moved"}});
  add({{"id", "none"}, {"do", "combine"}, {"expression", "bone - bone"}});
  session_->evaluate({}, false, {});
  const auto part = [&](const char* id) {
    return find_request_kind("part").answer(*session_, {{"object", id}}, {});
  };
  const Json both = part("both");
  EXPECT_EQ(both["parts"], 1);
  EXPECT_GT(both["mm3"], 0.0);
  EXPECT_NEAR(both["at_mm"][0].get<double>(), 3.0, 0.5);
  EXPECT_NEAR(both["at_mm"][1].get<double>(), 0.0, 0.5);
  EXPECT_TRUE(part("none")["at_mm"].is_null());
  EXPECT_THROW(part("nobody"), voxel::Error);
}

TEST_F(SessionTest, APartIsFoundAtAPointOfItsSurface) {
  voxel::write_scene(tests::ball_scene(3.0, 24), folder_ / "small.nrrd");
  session_->open(folder_ / "small.nrrd", {});
  add({{"id", "moved"}, {"do", "move"}, {"object", "bone"}, {"translate_mm", {8, 0, 0}}});
  add({{"id", "two"}, {"do", "combine"}, {"expression", "bone | moved"}});
  add({{"id", "one"}, {"do", "parts"}, {"object", "two"}, {"at_mm", {{0, 0, 0}}}});
  session_->evaluate({}, false, {});
  const auto part = [&](const char* id, const Json& near_mm) {
    return find_request_kind("part").answer(*session_, {{"object", id}, {"near_mm", near_mm}}, {});
  };
  const double one_mm3 = part("one", {0, 0, 0})["mm3"];
  const Json found = part("two", {0, 3.4, 0});
  EXPECT_EQ(found["parts"], 2);
  EXPECT_EQ(found["mm3"], one_mm3);
  EXPECT_EQ(found["whole_mm3"], 2.0 * one_mm3) << "moved by whole voxels";
  const glm::dvec3 at(found["at_mm"][0], found["at_mm"][1], found["at_mm"][2]);
  EXPECT_LT(glm::length(at), 2.2) << "deeper than the surface, so that both kernels have the point within";
  EXPECT_THROW(part("two", {0, 9, 0}), voxel::Error);
  EXPECT_THROW(part("two", {1e300, 0, 0}), voxel::Error);
}

TEST_F(SessionTest, StepsAreTriedWithoutAChangeOfThePlan) {
  session_->open(folder_ / "ball.nrrd", {});
  session_->evaluate({}, false, {});
  const Json before = session_->state()["plan"];
  const double bone_mm3 = session_->state()["objects"][0]["volume"]["value"];
  const Json held{{"id", "held"}, {"do", "clamp_streaks"}, {"scan", "ct"}, {"metal", 1}, {"low", -1},
                  {"high", 1}};
  const Json cleaned{{"id", "cleaned"}, {"do", "window"}, {"scan", "held"}, {"low", 1}};
  const Json same{{"id", "same"}, {"do", "parts"}, {"object", "bone"}, {"largest", 1}};
  const Json made = find_request_kind("try").answer(*session_, {{"steps", {held, cleaned, same}}}, {});
  ASSERT_EQ(made["scans"].size(), 1U);
  EXPECT_EQ(made["scans"][0]["id"], "held");
  EXPECT_GT(made["scans"][0]["details"]["lowered_samples"], 0);
  ASSERT_EQ(made["objects"].size(), 2U);
  EXPECT_EQ(made["objects"][0]["id"], "cleaned");
  const double cleaned_mm3 = made["objects"][0]["mm3"];
  EXPECT_GT(cleaned_mm3, 0.0);
  EXPECT_EQ(made["objects"][1], Json({{"id", "same"}, {"mm3", bone_mm3}}));
  EXPECT_EQ(session_->state()["plan"], before);
  const Session::Preview drawn = session_->preview({{"steps", {held, cleaned}}}, {}, {});
  ASSERT_EQ(drawn.evaluation->objects.size(), 1U);
  EXPECT_EQ(drawn.evaluation->objects[0].id, Session::Preview::moved);
  EXPECT_EQ(drawn.evaluation->objects[0].voxel.measures.volume_mm3, cleaned_mm3);
  EXPECT_THROW(find_request_kind("try").answer(*session_, {{"steps", Json::array()}}, {}),
               std::runtime_error);
}

TEST_F(SessionTest, AFoldersSeriesArePickedByThePerson) {
  const fs::path scans = folder_ / "scans";
  fs::create_directory(scans);
  EXPECT_EQ(find_request_kind("series").answer(*session_, {{"path", (folder_ / "ball.nrrd").string()}},
                                               {})["series"],
            Json::array());
  EXPECT_EQ(find_request_kind("series").answer(*session_, {{"path", scans.string()}}, {})["series"],
            Json::array());
  for (const int side : {24, 16}) {
    voxel::Scene ball = tests::ball_scene(5.0, side);
    ball.meaning = voxel::Meaning::Hounsfield;
    ball.modality = "CT";
    voxel::DicomOptions options;
    options.series_description = "side " + std::to_string(side);
    voxel::write_dicom_series(ball, scans / std::to_string(side), options);
  }
  const Json list = find_request_kind("series").answer(*session_, {{"path", scans.string()}}, {})["series"];
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[1]["name"], "side 16");
  EXPECT_EQ(list[1]["slices"], 16);
  EXPECT_EQ(list[1]["size"], Json({16, 16}));
  EXPECT_EQ(list[1]["spacing_mm"], Json({1.0, 1.0, 1.0}));
  const auto opened = [&](const Json& choice) {
    find_request_kind("open").answer(*session_, {{"path", scans.string()}, {"series", choice}}, {});
    return session_->state();
  };
  const Json second = opened(list[1]["choice"]);
  EXPECT_EQ(second["scans"][0]["dims"], Json({16, 16, 16}));
  EXPECT_EQ(opened(list[0]["choice"])["scans"][0]["dims"], Json({24, 24, 24}));
  EXPECT_EQ(opened(list[1]["choice"])["path"], second["path"]) << "its own plan again";
}

TEST_F(SessionTest, ALandmarkFarFromBoneIsNotCalledSnapped) {
  session_->open(folder_ / "ball.nrrd", {});
  session_->evaluate({}, false, {});
  const auto placed = [&](const Json& point) {
    return find_request_kind("landmark")
        .answer(*session_, {{"name", "a"}, {"point", point}, {"snap", true}}, {});
  };
  EXPECT_EQ(placed({0, -9, 0})["snapped"], true);
  const Json far = placed({11.5, -11.5, -11.5});
  EXPECT_EQ(far["snapped"], false);
  EXPECT_EQ(far["point"], Json({11.5, -11.5, -11.5}));
}

TEST_F(SessionTest, APreviewIsTheMoveStepsObject) {
  session_->open(folder_ / "ball.nrrd", {});
  session_->evaluate({}, false, {});
  const Json move{{"translate_mm", {2, 0, 0}}};
  const Session::Preview preview = session_->preview({{"object", "bone"}, {"move", move}}, {"bone"}, {});
  add({{"id", "moved"}, {"do", "move"}, {"object", "bone"}, {"translate_mm", {2, 0, 0}}});
  const Snapshot made = session_->evaluate({}, false, {});
  EXPECT_TRUE(preview.evaluation->object(Session::Preview::moved).voxel.octree ==
              made.evaluation->object("moved").voxel.octree);
  EXPECT_EQ(session_->state()["plan"]["steps"].size(), 2u) << "a preview is no step";
  const Session::Preview again = session_->preview({{"object", "bone"}, {"move", move}}, {}, {});
  EXPECT_EQ(again.evaluation->objects.size(), 2u) << "no overlap was asked for";
}

TEST_F(SessionTest, APreviewsDifferenceIsThatOfStepsOfThePlan) {
  session_->open(folder_ / "ball.nrrd", {});
  session_->evaluate({}, false, {});
  const Json move{{"translate_mm", {2, 0, 0}}};
  const Json asked{{"object", "bone"}, {"move", move}, {"difference", "bone"}};
  const Session::Preview preview = session_->preview(asked, {"bone"}, {});
  EXPECT_EQ(preview.evaluation->objects.size(), 5u) << "bone, the piece, and three parts; no overlap";
  add({{"id", "moved"}, {"do", "move"}, {"object", "bone"}, {"translate_mm", {2, 0, 0}}});
  add({{"id", "ahead"}, {"do", "combine"}, {"expression", "moved - bone"}});
  add({{"id", "left"}, {"do", "combine"}, {"expression", "bone - moved"}});
  add({{"id", "both"}, {"do", "combine"}, {"expression", "moved & bone"}});
  const Snapshot made = session_->evaluate({}, false, {});
  for (const auto& [part, step] : {std::pair(Session::Preview::only_moved, "ahead"),
                                   {Session::Preview::only_other, "left"},
                                   {Session::Preview::common, "both"}}) {
    EXPECT_TRUE(preview.evaluation->object(part).voxel.octree == made.evaluation->object(step).voxel.octree)
        << part;
    EXPECT_FALSE(preview.evaluation->object(part).voxel.octree.is_empty()) << part;
  }
  Json unknown = asked;
  unknown["difference"] = "nothing";
  EXPECT_ANY_THROW(session_->preview(unknown, {}, {}));
}

TEST_F(SessionTest, ACertificateIsOfTheStepAsItWas) {
  session_->open(folder_ / "ball.nrrd", {});
  session_->evaluate({}, true, {});
  const Json bone = session_->state()["objects"][0];
  EXPECT_EQ(bone["certificate"]["verdict"], "PASS") << bone;
  EXPECT_GT(bone["volume"]["half_width"], 0.0);
  session_->with_document([&](Document& document) {
    Json step = document.json()["steps"][0];
    step["low"] = 500;
    document.edit({{"replace", {{"id", "bone"}, {"step", step}}}});
  });
  session_->evaluate({}, false, {});
  EXPECT_FALSE(session_->state()["objects"][0].contains("certificate"));
  session_->with_document([](Document& document) { document.undo(); });
  EXPECT_TRUE(session_->state()["objects"][0].contains("certificate"));
}

TEST_F(SessionTest, APlanSavedInAnotherFolderReadsTheSameFiles) {
  const auto write_marks = [&](const fs::path& path, double x) {
    std::ofstream(path) << Json{{"landmarks", {{{"name", "ans"}, {"point_mm", {x, 0, 0}}}}}};
  };
  write_marks(folder_ / "marks.json", 1);
  fs::create_directory(folder_ / "other");
  write_marks(folder_ / "other/marks.json", 2);
  std::ofstream(folder_ / "own.plan.json") << R"({"octotomy_plan": 1, "name": "own",
    "scans": {"ct": {"path": "ball.nrrd"}}, "steps": [
      {"id": "marks", "do": "landmarks", "file": "marks.json"},
      {"id": "bone", "do": "window", "scan": "ct", "low": 0},
      {"id": "plate", "do": "import", "path": "plate.stl"},
      {"id": "piece", "do": "export", "object": "bone", "path": "piece.stl"}]})";
  session_->open(folder_ / "own.plan.json", {});
  const fs::path saved = folder_ / "other/q.plan.json";
  find_request_kind("save").answer(*session_, {{"path", saved.string()}}, {});
  const Plan plan = read_plan(saved);
  EXPECT_EQ(scan_path(plan, plan.scans.at("ct")).lexically_normal(), folder_ / "ball.nrrd");
  ASSERT_EQ(plan.landmarks.size(), 1u);
  EXPECT_EQ(plan.landmarks[0].p_mm.x, 1.0) << "the landmarks are those of the new folder";
  const Json steps = Json::parse(plan.text)["steps"];
  EXPECT_EQ(steps[2]["path"], "../plate.stl");
  EXPECT_EQ(steps[3]["path"], "piece.stl");
  find_request_kind("save").answer(*session_, {{"path", (folder_ / "same.plan.json").string()}}, {});
  EXPECT_EQ(read_plan(folder_ / "same.plan.json").text, read_plan(folder_ / "own.plan.json").text);
  EXPECT_ANY_THROW(find_request_kind("save").answer(*session_, {{"path", saved.string()}}, {}))
      << "it is there already";
}

TEST_F(SessionTest, AClosedOneLetsTheEditThatIsUnderWayEndAndTakesNoOther) {
  session_->open(folder_ / "ball.nrrd", {});
  std::atomic<bool> is_editing = false;
  std::jthread editing([&] {
    session_->with_document([&](Document& document) {
      is_editing = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      document.name_version("late");
    });
  });
  while (!is_editing) std::this_thread::yield();
  session_->close_within(std::chrono::seconds(10));
  editing.join();
  EXPECT_EQ(PlanHistory(folder_ / "ball.plan.json").newest(1)[0].names, std::vector<std::string>{"late"});
  EXPECT_THROW(session_->with_document([](Document&) {}), voxel::Error);
}

TEST_F(SessionTest, AStoppedEvaluationChangesNothing) {
  session_->open(folder_ / "ball.nrrd", {});
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(session_->evaluate({}, false, {stop.get_token(), {}}), Stopped);
  EXPECT_FALSE(session_->state()["objects"][0]["evaluated"]);
}

}  // namespace
}  // namespace octotomy::planner::serve
