// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/browser/server/plan_folders.h"

#include <gtest/gtest.h>

#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "tests/voxel/scratch_folder.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner::serve {
namespace {

TEST(PlanFolders, AMessageKeepsTheNamesOfFilesAndLosesTheirFolders) {
  const std::vector<std::string> folders{"/data/plans/../Doe Jane/", "/data/Doe Jane/", "../Doe Jane/",
                                         "/data/"};
  for (const auto& [said, shown] : std::vector<std::pair<std::string, std::string>>{
           {"/data/plans/../Doe Jane/ct.nrrd: the file is cut off", "ct.nrrd: the file is cut off"},
           {"'/data/Doe Jane/ct.nrrd' and '../Doe Jane/mr.nrrd'", "'ct.nrrd' and 'mr.nrrd'"},
           {"read /data/Doe Jane/CT", "read CT"},
           {"/elsewhere/a/b.stl: not found (/tmp/x/y)", "b.stl: not found (y)"},
           {"1/2 of https://example.org/a, 3 mm / 4 mm and/or less",
            "1/2 of https://example.org/a, 3 mm / 4 mm and/or less"},
           {"cannot read /other/Roe Ann/a b/x.stl, which is damaged", "cannot read x.stl, which is damaged"},
           {"'/other/Roe, Ann/x.stl' and /other/Roe Ann/y.stl", "'x.stl' and y.stl"},
           {"no path at all", "no path at all"}})
    EXPECT_EQ(without_folders(said, folders), shown);
}

TEST(PlanFolders, EveryTextOfAValueIsShortenedAndEachPathIsAName) {
  const Json said{
      {"path", "scans/Doe/ct.nrrd"}, {"n", 3}, {"list", {{{"error", "/data/a.nrrd: damaged"}}, "/data/b"}}};
  const Json shown{{"path", "ct.nrrd"}, {"n", 3}, {"list", {{{"error", "a.nrrd: damaged"}}, "b"}}};
  EXPECT_EQ(without_folders(said, std::vector<std::string>{"/data/"}), shown);
}

TEST(PlanFolders, TheFoldersOfAPlanAreThoseOfItsScansAndOfTheFilesOfItsSteps) {
  const tests::ScratchFolder scratch;
  const std::filesystem::path patient = scratch / "Doe Jane", plans = scratch / "plans";
  std::filesystem::create_directories(patient);
  std::filesystem::create_directories(plans);
  voxel::write_scene(tests::ball_scene(4.0, 12), patient / "ct.nrrd");
  tests::write_bytes(
      plans / "a.plan.json",
      R"({"octotomy_plan": 1, "name": "a", "scans": {"ct": {"path": "../Doe Jane/ct.nrrd"}}, "steps": [
          {"id": "bone", "do": "window", "scan": "ct", "low": 300}]})");
  Session session(scratch.path());
  session.open(plans / "a.plan.json", {});
  for (const std::string& folder :
       {plans.string(), plans.string() + "/../Doe Jane", patient.string(), std::string("../Doe Jane")})
    EXPECT_EQ(without_folders(folder + "/ct.nrrd: damaged", folders_of(session)), "ct.nrrd: damaged")
        << folder;
}

}  // namespace
}  // namespace octotomy::planner::serve
