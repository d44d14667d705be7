// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/document.h"

#include <fstream>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"
#include "voxel/space/error.h"

namespace octotomy::planner::serve {
namespace {

class DocumentTest : public testing::Test {
 protected:
  DocumentTest() {
    std::ofstream(folder_ / "a.plan.json") << R"({"octotomy_plan": 1, "name": "a",
      "scans": {"ct": {"path": "a.nrrd"}},
      "steps": [{"id": "bone", "do": "window", "scan": "ct", "low": 300}]})";
    folders_.open(folder_.path());
    document_ = std::make_unique<Document>(folder_ / "a.plan.json", folders_);
  }

  /// The ids of the steps, in their order.
  std::string ids() const {
    std::string text;
    for (const Step& step : document_->plan()->steps) text += step.id + " ";
    return text;
  }

  const Json skin_{{"id", "skin"}, {"do", "window"}, {"scan", "ct"}, {"low", -300}};
  tests::ScratchFolder folder_;
  Folders folders_;
  std::unique_ptr<Document> document_;
};

TEST_F(DocumentTest, StepsAreAddedReplacedAndRemoved) {
  document_->edit({{"add", {{"step", skin_}}}, {"what", "add the skin"}});
  EXPECT_EQ(ids(), "bone skin ");
  document_->edit(
      {{"add",
        {{"step", {{"id", "both"}, {"do", "combine"}, {"expression", "bone & bone"}}}, {"after", "bone"}}}});
  EXPECT_EQ(ids(), "bone both skin ");
  Json moved = skin_;
  moved["low"] = -200;
  document_->edit({{"replace", {{"id", "skin"}, {"step", moved}}}});
  EXPECT_EQ(document_->json()["steps"][2]["low"], -200);
  document_->edit({{"remove", "both"}});
  EXPECT_EQ(ids(), "bone skin ");
  EXPECT_EQ(document_->history_json()["history"][1]["what"], "add the skin");
  EXPECT_EQ(Json::parse(std::ifstream(folder_ / "a.plan.json")), document_->json()) << "the file is the plan";
}

TEST_F(DocumentTest, APlanThatReadsOutsideOfTheOpenFoldersIsNotOpenedUnlessItMayReadThere) {
  const auto plan = [&](const std::string& scan, const std::string& steps) {
    const std::filesystem::path path = folder_ / "elsewhere.plan.json";
    std::ofstream(path) << R"({"octotomy_plan": 1, "name": "a", "scans": {"ct": {"path": ")" << scan
                        << R"("}}, "steps": [)" << steps << "]}";
    return path;
  };
  const std::string bone = R"({"id": "bone", "do": "window", "scan": "ct", "low": 300})";
  EXPECT_THROW(Document(plan("/etc/passwd", bone), folders_), voxel::Error);
  EXPECT_THROW(Document(plan("a.nrrd", R"({"id": "l", "do": "landmarks", "file": "/etc/passwd"})"), folders_),
               voxel::Error);
  EXPECT_FALSE(std::filesystem::exists(PlanHistory::path_of(folder_ / "elsewhere.plan.json")))
      << "no history was begun";
  folders_.allow_reading("/etc/passwd");
  EXPECT_NO_THROW(Document(plan("/etc/passwd", bone), folders_));
}

TEST_F(DocumentTest, AFileThatAStepReadsWhileItIsParsedIsRefusedBeforeItIsRead) {
  const Json steps = Json::parse(R"([
    {"id": "x", "do": "landmarks", "file": "/etc/passwd"},
    {"id": "x", "do": "transform", "object": "bone", "file": "/etc/passwd"},
    {"id": "x", "do": "transform", "object": "bone", "file": "../../../../../../../../etc/passwd"},
    {"id": "x", "do": "saw", "object": "bone", "plane": "/etc/passwd"},
    {"id": "x", "do": "mask", "regions": [{"view": "anterior", "curves": ["/etc/passwd"]}]},
    {"id": "x", "do": "mask", "slices": "/etc/passwd"},
    {"id": "x", "do": "segment", "scan": "ct", "window": "bone", "regions": "/etc/passwd"},
    {"id": "x", "do": "warp", "object": "bone", "result": "/etc/passwd"}])");
  for (const Json& step : steps) {
    const auto message = [&](const auto& work) -> std::string {
      try {
        work();
      } catch (const voxel::Error& error) {
        return error.what();
      } catch (const std::exception& error) {
        return std::string("read: ") + error.what();
      }
      return "accepted";
    };
    for (const std::string& told : {message([&] {
                                      document_->edit({{"add", {{"step", step}}}});
                                    }),
                                    message([&] { document_->with_steps(Json::array({step})); })})
      EXPECT_NE(told.find("no folder that is open"), std::string::npos) << step << "\n" << told;
  }
  EXPECT_EQ(ids(), "bone ");
}

TEST_F(DocumentTest, AHistoryThatCameWithAPlanOpensNothingEither) {
  const std::filesystem::path path = folder_ / "a.plan.json";
  const Json own = document_->json();
  document_.reset();
  {
    PlanHistory history(path);
    Json scan = own, file = own;
    scan["scans"]["ct"]["path"] = "/etc/passwd";
    file["steps"].push_back({{"id", "l"}, {"do", "import"}, {"path", "/etc/passwd.stl"}});
    history.record(scan.dump(), "another scan");
    history.record(file.dump(), "a file");
    history.record(own.dump(), "as before");
  }
  document_ = std::make_unique<Document>(path, folders_);
  EXPECT_THROW(document_->undo(), voxel::Error);
  EXPECT_THROW(document_->go_to("2"), voxel::Error);
  EXPECT_THROW(document_->difference_of(1, 2), voxel::Error);
  EXPECT_EQ(document_->json(), own);
  EXPECT_EQ(document_->history_json()["edit"], 4) << "the refused states are not the current one";
  EXPECT_EQ(Json::parse(std::ifstream(path)), own) << "the file is the plan";
  document_->go_to("1");
  EXPECT_EQ(document_->history_json()["edit"], 1);
}

TEST_F(DocumentTest, APlanThatAnotherProgramWroteIsNotCalledSaved) {
  EXPECT_NO_THROW(document_->need_saved());
  document_->edit({{"add", {{"step", skin_}}}, {"what", "add the skin"}});
  EXPECT_NO_THROW(document_->need_saved());
  Json other = document_->json();
  other["name"] = "b";
  std::ofstream(folder_ / "a.plan.json") << other.dump();
  EXPECT_THROW(document_->need_saved(), std::runtime_error);
  document_ = std::make_unique<Document>(folder_ / "a.plan.json", folders_);
  EXPECT_NO_THROW(document_->need_saved());
  EXPECT_EQ(document_->json()["name"], "b") << "opened again, it goes on with what was written";
}

TEST_F(DocumentTest, WhatIsNoPlanChangesNothing) {
  const std::string before = document_->plan()->text;
  for (const Json& wrong :
       {Json{{"remove", "bone"}}, Json{{"remove", "bome"}}, Json{{"add", {{"step", 5}}}}, Json{{"add", 5}},
        Json{{"steps", Json::array()}}, Json{{"add", {{"step", skin_}, {"after", "nobody"}}}},
        Json{{"replace", {{"id", "bone"}, {"step", {{"id", "bone"}}}}}}, Json{{"scans", 5}}})
    EXPECT_ANY_THROW(document_->edit(wrong)) << wrong;
  EXPECT_EQ(document_->plan()->text, before);
  EXPECT_EQ(document_->history_json()["edit"], 1);
}

TEST_F(DocumentTest, ScansAndFilesLieInOpenFolders) {
  const std::string before = document_->plan()->text;
  EXPECT_THROW(document_->edit({{"scans", {{"ct", {{"path", "/etc/passwd"}}}}}}), voxel::Error);
  EXPECT_THROW(document_->edit({{"add", {{"step", {{"id", "in"}, {"do", "import"}, {"path", "../b.stl"}}}}}}),
               voxel::Error);
  EXPECT_EQ(document_->plan()->text, before);
  document_->edit({{"add", {{"step", {{"id", "in"}, {"do", "import"}, {"path", "b.stl"}}}}}});
  EXPECT_EQ(ids(), "bone in ");
}

TEST_F(DocumentTest, UndoRedoAndBranchesAreTold) {
  EXPECT_FALSE(document_->history_json()["can_undo"]);
  document_->edit({{"add", {{"step", skin_}}}});
  EXPECT_TRUE(document_->history_json()["can_undo"]);
  EXPECT_TRUE(document_->undo());
  EXPECT_EQ(ids(), "bone ");
  EXPECT_TRUE(document_->history_json()["can_redo"]);
  EXPECT_TRUE(document_->redo());
  EXPECT_FALSE(document_->redo());
  document_->begin_branch("other");
  EXPECT_EQ(document_->history_json()["branch"], "other");
  EXPECT_EQ(document_->difference_of(1, 2)["added"], Json::array({"skin"}));
  EXPECT_EQ(document_->difference_of(1, 2)["rows"], Json::array({"+ step 'skin'"}));
  EXPECT_EQ(document_->difference_of(2, 2)["rows"], Json::array({"the plans are the same"}));
  document_->go_to("1");
  EXPECT_EQ(ids(), "bone ");
}

TEST_F(DocumentTest, AStateBelowTheListedOnesCanBeUndoneAndRedone) {
  Json step = skin_;
  document_->edit({{"add", {{"step", step}}}});
  for (int number = 0; number < 205; ++number) {
    step["low"] = number;
    document_->edit({{"replace", {{"id", "skin"}, {"step", step}}}});
  }
  document_->go_to("3");
  const Json told = document_->history_json();
  EXPECT_GT(told["history"][0]["id"], 3) << "the state is listed after all";
  EXPECT_TRUE(told["can_undo"]);
  EXPECT_TRUE(told["can_redo"]);
  document_->edit({{"remove", "skin"}});
  document_->go_to("200");
  EXPECT_FALSE(document_->history_json()["can_redo"]) << "the branch leads past it";
  EXPECT_FALSE(document_->redo());
}

TEST_F(DocumentTest, TextsWithControlCharactersAreRefused) {
  const std::string before = document_->plan()->text;
  for (const Json& wrong :
       {Json{{"name", std::string("\0\x1b", 2)}}, Json{{"name", "two\nlines"}},
        Json{{"scans", {{"ct", {{"path", "a.nrrd"}}}, {"c\x1b[31m", {{"path", "a.nrrd"}}}}}},
        Json{{"add", {{"step", skin_}}}, {"what", "red \x1b[31m"}}})
    EXPECT_THROW(document_->edit(wrong), std::runtime_error) << wrong;
  EXPECT_EQ(document_->plan()->text, before);
  document_->edit({{"name", "le nom pr\u00e9vu"}});
  EXPECT_EQ(document_->plan()->name, "le nom pr\u00e9vu");
}

TEST_F(DocumentTest, LandmarksStandBeforeTheStepsThatUseThem) {
  document_->place_landmark("ans", {0, -80, 10});
  EXPECT_EQ(ids(), "landmarks bone ");
  document_->place_landmark("pns", {0, -40, 10});
  document_->place_landmark("ans", {1, -80, 10});
  ASSERT_EQ(document_->plan()->landmarks.size(), 2u);
  EXPECT_EQ(document_->plan()->landmarks[0].p_mm, glm::dvec3(1, -80, 10));
}

TEST_F(DocumentTest, NewLandmarksHaveNamesThatAListCanShow) {
  const std::string longest(200, 'n');
  document_->place_landmark(longest, {0, -80, 10});
  const auto step = [](const std::string& name) -> Json {
    return {
        {"id", "landmarks"}, {"do", "landmarks"}, {"points", {{{"name", name}, {"point_mm", {1, 2, 3}}}}}};
  };
  const std::string before = document_->plan()->text;
  for (const std::string& wrong : {longest + "n", std::string("a\nb"), std::string("\x1b[31m")}) {
    EXPECT_THROW(document_->place_landmark(wrong, {0, 0, 0}), std::runtime_error) << wrong;
    EXPECT_THROW(document_->edit({{"landmarks", {{{"name", wrong}, {"point", {0, 0, 0}}}}}}),
                 std::runtime_error)
        << wrong;
    EXPECT_THROW(document_->edit({{"replace", {{"id", "landmarks"}, {"step", step(wrong)}}}}),
                 std::runtime_error)
        << wrong;
  }
  EXPECT_EQ(document_->plan()->text, before);
}

TEST_F(DocumentTest, ALongNameThatThePlanHasAlreadyStays) {
  const std::string name(300, 'n');
  std::ofstream(folder_ / "b.plan.json") << R"({"octotomy_plan": 1, "name": "b",
    "scans": {"ct": {"path": "a.nrrd"}}, "steps": [{"id": "landmarks", "do": "landmarks", "points":
    [{"name": ")" << name << R"(", "point_mm": [1, 2, 3]}]}]})";
  document_ = std::make_unique<Document>(folder_ / "b.plan.json", folders_);
  document_->edit({{"add", {{"step", skin_}}}});
  document_->place_landmark(name, {3, 2, 1});
  EXPECT_EQ(document_->plan()->landmarks.at(0).p_mm, glm::dvec3(3, 2, 1));
}

TEST_F(DocumentTest, AnotherDocumentOfTheSameFileGoesOn) {
  document_->edit({{"add", {{"step", skin_}}}});
  document_.reset();
  document_ = std::make_unique<Document>(folder_ / "a.plan.json", folders_);
  EXPECT_EQ(ids(), "bone skin ");
  EXPECT_TRUE(document_->undo());
}

}  // namespace
}  // namespace octotomy::planner::serve
