// SPDX-License-Identifier: AGPL-3.0-or-later
// The verbs of a plan as a document: plan diff, plan merge, plan history, preview and procedure.
#include "tests/file_bytes.h"
#include "tests/planner/cli/program/command_line.h"

namespace octotomy::planner {
namespace {

class PlanDocument : public tests::CommandLine {
 protected:
  /// Runs the program in the test's folder, so that files are named without it.
  tests::CommandAnswer run(const std::string& arguments) const {
    return tests::run_command(
        "cd '" + folder_.path().string() + "' && " OCTOTOMY_BINARY_DIR "/octotomy " + arguments,
        folder_ / "");
  }
  std::string plan(const std::string& low, const std::string& more = "") const {
    return R"({"octotomy_plan": 1, "name": "p", "scans": {"ct": {"path": "ball.nrrd"}}, "steps": [
        {"id": "ball", "do": "window", "scan": "ct", "low": )" +
           low + "}" + more + "]}";
  }
};

constexpr const char* cut = R"(, {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
    "polygons_mm": [[[-20, 40], [20, 40], [20, 50], [-20, 50]]]}]})";

TEST_F(PlanDocument, DiffNamesStepsAndFields) {
  write("a.plan.json", plan("0"));
  write("b.plan.json", plan("10", R"(, {"id": "size", "do": "measure", "object": "ball"})"));
  const auto told = run("plan diff a.plan.json b.plan.json");
  EXPECT_EQ(told.status, 0) << told.errors;
  EXPECT_EQ(told.out, "~ step 'ball', low: 0.0 -> 10.0\n+ step 'size'\n");
  const auto json = tests::SortedJson::parse(run("plan diff a.plan.json b.plan.json --json").out);
  EXPECT_EQ(json.at("changed")[0].at("id"), "ball");
  EXPECT_EQ(json.at("added")[0], "size");
  expect_refused(run("plan diff a.plan.json none.plan.json"), "none.plan.json");
}

TEST_F(PlanDocument, MergeWritesWhatAgreesAndNothingWhereItDoesNot) {
  write("base.plan.json", plan("0"));
  write("a.plan.json", plan("10"));
  write("b.plan.json", plan("0", R"(, {"id": "size", "do": "measure", "object": "ball"})"));
  EXPECT_EQ(run("plan merge base.plan.json a.plan.json b.plan.json -o merged.plan.json").status, 0);
  const auto merged = tests::SortedJson::parse(tests::bytes_of(folder_ / "merged.plan.json"));
  EXPECT_EQ(merged.at("steps")[0].at("low"), 10);
  EXPECT_EQ(merged.at("steps").size(), 2u);
  write("b.plan.json", plan("20"));
  expect_refused(run("plan merge base.plan.json a.plan.json b.plan.json -o clash.plan.json"),
                 "step 'ball', low: 0 became 10 in A and 20 in B");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "clash.plan.json"));
  const auto told = run("plan merge base.plan.json a.plan.json b.plan.json -o clash.plan.json --json");
  EXPECT_EQ(told.status, 2);
  EXPECT_EQ(tests::SortedJson::parse(told.out).at("conflicts")[0].at("field"), "low");
}

TEST_F(PlanDocument, MergeReplacesNeitherAScanNorAPlanThatItReads) {
  write("base.plan.json", plan("0"));
  write("a.plan.json", plan("10"));
  std::filesystem::create_symlink("a.plan.json", folder_ / "link.plan.json");
  const std::string scan = tests::bytes_of(folder_ / "ball.nrrd");
  const std::string merge = "plan merge base.plan.json a.plan.json base.plan.json -o ";
  expect_refused(run(merge + "ball.nrrd"), "ball.nrrd: a plan is written as .json");
  expect_refused(run(merge + "./base.plan.json"), "base.plan.json: would replace");
  expect_refused(run(merge + "link.plan.json"), "link.plan.json: would replace");
  EXPECT_EQ(tests::bytes_of(folder_ / "ball.nrrd"), scan);
  EXPECT_EQ(tests::bytes_of(folder_ / "base.plan.json"), plan("0"));
  EXPECT_EQ(tests::bytes_of(folder_ / "a.plan.json"), plan("10"));
}

TEST_F(PlanDocument, PlansOfOtherFoldersMergeAndFindTheirScan) {
  std::filesystem::create_directories(folder_ / "mine");
  write("base.plan.json", plan("0"));
  auto mine = tests::SortedJson::parse(plan("10"));
  mine["scans"]["ct"]["path"] = "../ball.nrrd";
  write("mine/a.plan.json", mine.dump());
  ASSERT_EQ(run("plan merge base.plan.json mine/a.plan.json base.plan.json -o mine/merged.plan.json").status,
            0);
  const auto merged = tests::SortedJson::parse(tests::bytes_of(folder_ / "mine/merged.plan.json"));
  EXPECT_EQ(merged.at("scans").at("ct").at("path"), "../ball.nrrd");
  EXPECT_EQ(merged.at("steps")[0].at("low"), 10);
  EXPECT_EQ(run("run mine/merged.plan.json -o report --no-certificates").status, 0);
}

TEST_F(PlanDocument, ASignatureHoldsUntilThePlanOrItsScanChanges) {
  write("my.plan.json", plan("0"));
  EXPECT_NE(run("plan sign my.plan.json").out.find("nobody"), std::string::npos);
  ASSERT_EQ(run("plan sign my.plan.json --by 'A. Reader' --as 'second reader' --note 'kerf checked'").status,
            0);
  const std::string text = tests::bytes_of(folder_ / "my.plan.json");
  EXPECT_NE(run("plan sign my.plan.json").out.find("A. Reader, second reader: holds (kerf checked)"),
            std::string::npos);
  ASSERT_EQ(run("run my.plan.json -o report --no-certificates").status, 0);
  auto result = tests::SortedJson::parse(tests::bytes_of(folder_ / "report/result.json"));
  EXPECT_TRUE(result.at("signatures")[0].at("changed_since").empty());
  // A changed layout is no change of the plan; a changed number is one.
  write("my.plan.json", tests::SortedJson::parse(text).dump());
  EXPECT_NE(run("plan sign my.plan.json").out.find(": holds"), std::string::npos);
  auto changed = tests::SortedJson::parse(text);
  changed["steps"][0]["low"] = 1;
  write("my.plan.json", changed.dump());
  EXPECT_NE(run("plan sign my.plan.json").out.find("the plan changed since"), std::string::npos);
  ASSERT_EQ(run("run my.plan.json -o report --no-certificates").status, 0);
  result = tests::SortedJson::parse(tests::bytes_of(folder_ / "report/result.json"));
  EXPECT_EQ(result.at("signatures")[0].at("changed_since")[0], "the plan");
  EXPECT_NE(result.at("findings").dump().find("it must be read and signed again"), std::string::npos);
  changed["signatures"][0].erase("by");
  write("my.plan.json", changed.dump());
  expect_refused(run("plan sign my.plan.json"), "signatures[0]");
}

TEST_F(PlanDocument, AReportIsPrintedByWhatPrintsPagesAndRefusedBeforeTheWorkWithoutOne) {
  write("my.plan.json", plan("0"));
  const auto with_path = [&](const std::string& path) {
    return tests::run_command("cd '" + folder_.path().string() + "' && PATH='" + path +
                                  "' " OCTOTOMY_BINARY_DIR
                                  "/octotomy run my.plan.json -o report "
                                  "--no-certificates --pdf",
                              folder_ / "");
  };
  const std::string bin = (folder_ / "bin").string();
  std::filesystem::create_directory(bin);
  expect_refused(with_path(bin), "apt-get install chromium");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "report"));
  write("bin/chromium",
        "#!/bin/sh\nfor word; do case $word in --print-to-pdf=*) pdf=${word#*=};; file://*) "
        "page=${word#file://};; "
        "esac; done\n/bin/cp \"$page\" \"$pdf\"\n");
  std::filesystem::permissions(folder_ / "bin/chromium", std::filesystem::perms::owner_all);
  EXPECT_EQ(with_path(bin).status, 0);
  EXPECT_EQ(tests::bytes_of(folder_ / "report/report.pdf"), tests::bytes_of(folder_ / "report/report.html"));
  write("bin/chromium", "#!/bin/sh\nexit 1\n");
  const auto failed = with_path(bin);
  EXPECT_EQ(failed.status, 3) << failed.errors;
  EXPECT_NE(failed.errors.find("leave out --pdf"), std::string::npos) << failed.errors;
}

TEST_F(PlanDocument, HistoryRecordsWhatAnEditorChangesAndGoesBack) {
  write("my.plan.json", plan("0"));
  EXPECT_EQ(run("plan history my.plan.json --name first").status, 0);
  write("my.plan.json", plan("10"));
  const auto told = tests::SortedJson::parse(run("plan history my.plan.json --json").out);
  EXPECT_EQ(told.at("count"), 2);
  EXPECT_EQ(told.at("edits")[0].at("what"), "changed outside");
  EXPECT_EQ(run("plan history my.plan.json --undo").status, 0);
  EXPECT_EQ(tests::bytes_of(folder_ / "my.plan.json"), plan("0"));
  expect_refused(run("plan history my.plan.json --undo"), "first state");
  EXPECT_EQ(run("plan history my.plan.json --redo").status, 0);
  EXPECT_EQ(run("plan history my.plan.json --go-to first").status, 0);
  EXPECT_EQ(tests::bytes_of(folder_ / "my.plan.json"), plan("0"));
  expect_refused(run("plan history my.plan.json --go-to frist"), "did you mean 'first'?");
}

TEST_F(PlanDocument, WhoSignsHasANameThatATerminalCanShow) {
  write("my.plan.json", plan("0"));
  for (const char* wrong : {"--by 'A\033[31m'", "--by A --as 'two\nlines'", "--by A --note 'bell\a'"})
    expect_refused(run(std::string("plan sign my.plan.json ") + wrong), "has control characters");
  EXPECT_EQ(tests::bytes_of(folder_ / "my.plan.json"), plan("0"));
  ASSERT_EQ(run("plan sign my.plan.json --by 'A. Reader'").status, 0);
  // Another program may have signed otherwise.
  auto signed_plan = tests::SortedJson::parse(tests::bytes_of(folder_ / "my.plan.json"));
  signed_plan["signatures"][0]["by"] = "red \033[31m";
  write("my.plan.json", signed_plan.dump());
  const auto told = run("plan sign my.plan.json");
  EXPECT_EQ(told.status, 0) << told.errors;
  EXPECT_EQ(told.out.find('\033'), std::string::npos) << told.out;
}

TEST_F(PlanDocument, PreviewDrawsOneStepAndTellsAMaskThatCutsNothing) {
  write("my.plan.json",
        plan("0", std::string(cut) + R"(, {"id": "cap", "do": "combine", "expression": "ball & cut"})"));
  const auto told = run("preview my.plan.json cap -o cap.png --view left --size 64");
  // The mask lies beyond the universe, which is refused where it is drawn.
  expect_refused(told, "step 'cut'");
  write("my.plan.json", plan("0", R"(, {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
      "polygons_mm": [[[-15, 13.5], [15, 13.5], [15, 15], [-15, 15]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"}, {"id": "cup", "do": "combine",
          "expression": "ball - cut"})"));
  const auto drawn = run("preview my.plan.json cup -o cup.png --view left --size 64 --json");
  EXPECT_EQ(drawn.status, 0) << drawn.errors;
  EXPECT_EQ(tests::bytes_of(folder_ / "cup.png").substr(1, 3), "PNG");
  EXPECT_NE(drawn.errors.find("the mask 'cut' contains nothing of 'ball'"), std::string::npos)
      << drawn.errors;
  // Like every verb that draws numbers from a scan, its answer contains the scan's audit.
  EXPECT_TRUE(tests::SortedJson::parse(drawn.out)["scans"][0].contains("audit")) << drawn.out;
  const auto ran = run("run my.plan.json -o out --no-certificates");
  EXPECT_EQ(ran.status, 0);
  EXPECT_NE(ran.errors.find("no voxel lies in 'ball & cut'"), std::string::npos) << ran.errors;
  EXPECT_NE(ran.errors.find("cap: the mask 'cut' contains nothing of 'ball'"), std::string::npos)
      << ran.errors;
  expect_refused(run("preview my.plan.json cup -o cup.jpg"), ".png");
}

TEST_F(PlanDocument, CertificatesThatComeLaterAreThoseOfNowAndKeepTheExports) {
  write("my.plan.json",
        plan("0", R"(, {"id": "out", "do": "export", "object": "ball", "path": "ball.stl"})"));
  const auto later = run("run my.plan.json -o later --certify later");
  ASSERT_EQ(later.status, 0) << later.errors;
  EXPECT_NE(later.errors.find("written without certificates"), std::string::npos) << later.errors;
  ASSERT_EQ(run("run my.plan.json -o now").status, 0);
  ASSERT_EQ(run("run my.plan.json -o never --certify never").status, 0);
  const auto result = [&](const char* folder) {
    auto json = tests::SortedJson::parse(tests::bytes_of(folder_ / folder / "result.json"));
    for (auto& certificate : json.at("certificates")) certificate.erase("timings_ms");
    return json;
  };
  EXPECT_EQ(result("later").at("certificates"), result("now").at("certificates"));
  EXPECT_EQ(result("later").at("findings"), result("now").at("findings"));
  EXPECT_EQ(result("later").at("exports"), result("now").at("exports"));
  EXPECT_EQ(tests::bytes_of(folder_ / "later/ball.stl"), tests::bytes_of(folder_ / "now/ball.stl"));
  EXPECT_NE(result("now").at("certificates"), result("never").at("certificates"));
  EXPECT_NE(result("never").at("findings").dump().find("--certify never"), std::string::npos);
}

TEST_F(PlanDocument, AProcedureIsListedExplainedAndPlanned) {
  EXPECT_NE(run("procedure").out.find("le_fort_i"), std::string::npos);
  EXPECT_NE(run("procedure le_fort_i").out.find("--set forward_mm=0"), std::string::npos);
  write("marks.json", R"({"landmarks": [{"name": "ans", "point_mm": [0, 0, 0]}]})");
  expect_refused(run("procedure le_fort_i --scan ball.nrrd --landmarks marks.json -o p.plan.json"),
                 "lacks landmarks");
  expect_refused(run("procedure le_fort_i --scan ball.nrrd"), "--landmarks");
  expect_refused(run("procedure le_fort_i --scan ball.nrrd --landmarks marks.json -o ball.nrrd"),
                 "ball.nrrd: a plan is written as .json");
  expect_refused(run("procedure le_fort_i --scan ball.nrrd --landmarks marks.json -o marks.json"),
                 "marks.json: would replace");
  write("own.json", R"({"procedure": "own", "says": "Own.", "landmarks": [{"name": "ans", "says": "any."}],
      "values": [{"name": "up_mm", "says": "up", "preset": 1, "least": 0, "most": 5}], "steps": [
      {"id": "bone", "do": "window", "scan": "ct", "low": 0},
      {"id": "m", "do": "move", "object": "bone", "by": {"up_mm": "=up_mm * 2 + ans.x"}}]})");
  EXPECT_EQ(
      run("procedure own.json --scan ball.nrrd --landmarks marks.json --set up_mm=2 -o p.plan.json").status,
      0);
  const auto made = run("run p.plan.json -o out --json");
  ASSERT_EQ(made.status, 0) << made.errors;
  const auto result = tests::SortedJson::parse(made.out);
  EXPECT_NEAR(result.at("movements")[0].at("centroid").at("up_mm").get<double>(), 4.0, 1e-9);
  EXPECT_EQ(result.at("landmarks")[0].at("name"), "ans");
}

TEST_F(PlanDocument, AProcedurePlansAndReportsInOneCommand) {
  write("marks.json", R"({"landmarks": [{"name": "ans", "point_mm": [0, 0, 0]}]})");
  write("own.json", R"({"procedure": "own", "says": "Own.", "landmarks": [{"name": "ans", "says": "any."}],
      "values": [{"name": "up_mm", "says": "up", "preset": 1, "least": 0, "most": 5}], "steps": [
      {"id": "bone", "do": "window", "scan": "ct", "low": 0},
      {"id": "m", "do": "move", "object": "bone", "by": {"up_mm": "=up_mm"}}]})");
  const std::string planned =
      "procedure own.json --scan ball.nrrd --landmarks marks.json --set up_mm=2 -o p.plan.json --report ";
  const auto made = run(planned + "out --certify never --json");
  ASSERT_EQ(made.status, 0) << made.errors;
  EXPECT_NEAR(tests::SortedJson::parse(made.out).at("movements")[0].at("centroid").at("up_mm").get<double>(),
              2.0, 1e-9);
  EXPECT_TRUE(tests::SortedJson::parse(made.out).at("certificates").empty());
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/report.html"));
  // The result equals that of the written plan, replayed.
  ASSERT_EQ(run("run p.plan.json -o again --certify never").status, 0);
  EXPECT_EQ(tests::bytes_of(folder_ / "out/views/after_left.png"),
            tests::bytes_of(folder_ / "again/views/after_left.png"));
  write("out/mine.txt", "mine");
  EXPECT_EQ(run(planned + "out").status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/mine.txt"));
  EXPECT_FALSE(
      tests::SortedJson::parse(tests::bytes_of(folder_ / "out/result.json")).at("certificates").empty());
  std::filesystem::create_directory(folder_ / "full");
  write("full/a.txt", "a");
  expect_refused(run(planned + "full"), "full");
}

}  // namespace
}  // namespace octotomy::planner
