// SPDX-License-Identifier: AGPL-3.0-or-later
#include <gtest/gtest.h>

#include "planner/plan/plan_results.h"
#include "tests/planner/operation/ball_operation.h"
#include "voxel/scan/read_scene.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// All samples of the scan in a box about the upper cap, moved by 10.25 mm to the patient's left, and the rest.
std::string moved_cap(const std::string& expression, const std::string& more = "") {
  return R"({"id": "head", "do": "window", "scan": "ct", "low": -30000},
      {"id": "cut", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-22.4, 5.4], [22.4, 5.4], [22.4, 22.4], [-22.4, 22.4]]]}]},
      {"id": "piece", "do": "combine", "expression": "head & cut"},
      {"id": "rest", "do": "combine", "expression": "head - cut"},
      {"id": "moved", "do": "move", "object": "piece", "translate_mm": [10.25, 0, 0]},
      {"id": "operated", "do": "scan_of", "scan": "ct", "expression": ")" +
         expression + "\"" + more + "}";
}

EvaluateOptions keeping_scans() {
  EvaluateOptions options;
  options.keep_scans = true;
  return options;
}

double value_at(const voxel::Scene& scene, const glm::ivec3& at) {
  return std::visit(
      [&](const auto& samples) {
        const glm::ivec3& dims = scene.lattice.dims;
        return static_cast<double>(samples[static_cast<std::size_t>(at.x + dims.x * (at.y + dims.y * at.z))]);
      },
      scene.samples);
}

TEST(ScanOf, EachSampleComesFromThePieceThatOwnsItsPlaceAndHolesAreMarked) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, moved_cap("moved | rest"));
  const Evaluation evaluation = evaluate(plan, keeping_scans());
  const voxel::Scene& before = evaluation.loaded.at("ct")->scene();
  const voxel::Scene& after = evaluation.loaded.at("operated")->scene();
  ASSERT_TRUE(after.padding);
  const auto is_cut = [](const glm::dvec3& p_mm) {
    return std::abs(p_mm.x) < 22.4 && p_mm.z > 5.4 && p_mm.z < 22.4;
  };
  const glm::dvec3 by_mm(10.25, 0.0, 0.0);
  std::size_t holes = 0, moved = 0;
  for (int z = 0; z < before.lattice.dims.z; ++z)
    for (int y = 0; y < before.lattice.dims.y; ++y)
      for (int x = 0; x < before.lattice.dims.x; ++x) {
        const glm::ivec3 at(x, y, z);
        const glm::dvec3 p_mm = before.lattice.lps_mm(glm::dvec3(at));
        if (is_cut(p_mm - by_mm)) {
          const glm::dvec3 from(glm::inverse(before.lattice.lps_from_voxel) * glm::dvec4(p_mm - by_mm, 1.0));
          ASSERT_EQ(value_at(after, at), std::floor(voxel::interpolate(before, from) + 0.5));
          ++moved;
        } else if (is_cut(p_mm)) {
          ASSERT_EQ(value_at(after, at), *after.padding);
          ++holes;
        } else {
          ASSERT_EQ(value_at(after, at), value_at(before, at));
        }
      }
  EXPECT_GT(moved, 1000u);
  const auto& details = evaluation.scans.back().details;
  EXPECT_EQ(details["hole_samples"], holes);
  EXPECT_EQ(details["second_reading"]["differing"], 0);
  EXPECT_GT(details["second_reading"]["compared"].get<int>(), 10000);
}

TEST(ScanOf, AWindowOfTheMadeScanIsTheMovedObject) {
  const ScratchFolder folder;
  const Plan plan = ball_plan(folder, moved_cap("moved | rest") + R"json(,
      {"id": "seen", "do": "window", "scan": "operated", "low": 0},
      {"id": "bone_piece", "do": "combine", "expression": "ball & cut"},
      {"id": "bone_moved", "do": "move", "object": "bone_piece", "translate_mm": [10.25, 0, 0]},
      {"id": "planned", "do": "combine", "expression": "bone_moved | (ball - cut)"})json");
  const Evaluation evaluation = evaluate(plan);
  const double planned = evaluation.objects.at("planned").voxel.measures.volume_mm3;
  EXPECT_NEAR(evaluation.objects.at("seen").voxel.measures.volume_mm3 / planned, 1.0, 0.03);
  const std::string values = testing::PrintToString(evaluation.objects.at("seen").shared_values);
  EXPECT_NE(values.find("scan_of"), std::string::npos) << values;
}

TEST(ScanOf, HolesTakeAChosenValueAndTheAuditSaysSo) {
  const ScratchFolder folder;
  const Plan plan =
      ball_plan(folder, moved_cap("moved | rest", R"(, "hole_value": 40)") +
                            R"(, {"id": "file", "do": "scan_file", "scan": "operated", "path": "o.nrrd"})");
  const Evaluation evaluation = evaluate(plan, keeping_scans());
  const std::vector<voxel::Finding>& audit = evaluation.scans.back().audit;
  EXPECT_TRUE(std::any_of(audit.begin(), audit.end(), [](const voxel::Finding& finding) {
    return finding.check == "scan_of" && finding.verdict == voxel::Verdict::Warn;
  }));
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder.path(), timings);
  ASSERT_EQ(files.size(), 1u);
  ASSERT_TRUE(files[0].written) << testing::PrintToString(files[0].findings);
  const voxel::Scene read = voxel::read_scene(folder / "o.nrrd");
  const voxel::Scene& made = evaluation.loaded.at("operated")->scene();
  ASSERT_EQ(read.lattice.dims, made.lattice.dims);
  for (const glm::ivec3& at : {glm::ivec3(3, 4, 5), made.lattice.dims / 2, made.lattice.dims - 2})
    EXPECT_EQ(value_at(read, at), value_at(made, at));
}

/// Steps for a scan of one expression after others.
std::string scan_of(const std::string& before, const std::string& expression, const std::string& more = "") {
  return before + R"(, {"id": "operated", "do": "scan_of", "scan": "ct", "expression": ")" + expression +
         "\"" + more + "}";
}

bool warns(const Evaluation& evaluation, const std::string& of) {
  const std::vector<voxel::Finding>& audit = evaluation.scans.back().audit;
  return std::any_of(audit.begin(), audit.end(), [&](const voxel::Finding& finding) {
    return finding.check == "scan_of" && finding.verdict == voxel::Verdict::Warn &&
           finding.detail.find(of) != std::string::npos;
  });
}

TEST(ScanOf, ObjectsWithoutWindowsOfTheirOwnKeepTheSamplesOfTheirScan) {
  const std::string cavity = R"({"id": "hollow", "do": "shell", "object": "ball", "thickness_mm": 5},
      {"id": "full", "do": "fill", "object": "hollow"})";
  const std::string smooth = R"({"id": "even", "do": "smooth", "object": "ball", "rounds": 5})";
  const std::string seeded =
      R"({"id": "grown", "do": "segment", "scan": "ct", "window": "500:", "seeds_mm": [[0, 0, 0]]})";
  for (const auto& [steps, name] :
       {std::pair(cavity, "full"), std::pair(smooth, "even"), std::pair(seeded, "grown")}) {
    const ScratchFolder folder;
    const Evaluation evaluation = evaluate(ball_plan(folder, scan_of(steps, name)), keeping_scans());
    const voxel::Scene& before = evaluation.loaded.at("ct")->scene();
    const voxel::Scene& after = evaluation.loaded.at("operated")->scene();
    const glm::ivec3 middle = before.lattice.dims / 2;
    EXPECT_EQ(value_at(after, middle), value_at(before, middle)) << name;
    const auto& details = evaluation.scans.back().details;
    EXPECT_EQ(details["filled_samples"], 0) << name;
    EXPECT_EQ(details["second_reading"]["differing"], 0) << name << details.dump();
    EXPECT_GT(details["changed_samples"], 1000) << name << ": holes about the ball";
  }
}

TEST(ScanOf, SamplesOfAMovedSmoothObjectMoveWithIt) {
  const ScratchFolder folder;
  const std::string steps = R"({"id": "even", "do": "smooth", "object": "ball", "rounds": 5},
      {"id": "away", "do": "move", "object": "even", "translate_mm": [8.5, 0, 0]},
      {"id": "half", "do": "mask", "regions": [{"view": "anterior",
          "polygons_mm": [[[-40, -40], [40, -40], [40, 0.2], [-40, 0.2]]]}]},
      {"id": "part", "do": "combine", "expression": "away & half"})";
  const Evaluation evaluation = evaluate(ball_plan(folder, scan_of(steps, "part")), keeping_scans());
  const auto& details = evaluation.scans.back().details;
  EXPECT_EQ(details["filled_samples"], 0);
  EXPECT_EQ(details["second_reading"]["differing"], 0) << details.dump();
  const voxel::Scene& before = evaluation.loaded.at("ct")->scene();
  const voxel::Scene& after = evaluation.loaded.at("operated")->scene();
  // At the ball's right border, half a voxel between two samples.
  const glm::ivec3 at(before.lattice.voxel({-10.5, 0.5, -0.5}) + 0.5);
  const glm::dvec3 from = glm::dvec3(at) - glm::dvec3(8.5, 0, 0);
  EXPECT_EQ(value_at(after, at), std::floor(voxel::interpolate(before, from) + 0.5));
}

TEST(ScanOf, CountsSamplesOfObjectsThatComeFromNoScan) {
  const ScratchFolder folder;
  const Evaluation evaluation =
      evaluate(ball_plan(folder, scan_of(R"({"id": "thick", "do": "offset", "object": "ball", "by_mm": 2})",
                                         "ball | thick", R"(, "filled_value": 77)")),
               keeping_scans());
  const auto& details = evaluation.scans.back().details;
  const auto& objects = evaluation.objects;
  // The two lattices coincide, so that each voxel is a sample.
  const std::uint64_t beside =
      objects.at("thick").voxel.octree.voxel_count() - objects.at("ball").voxel.octree.voxel_count();
  EXPECT_EQ(details["filled_samples"], beside);
  EXPECT_GT(beside, 1000u);
  EXPECT_TRUE(warns(evaluation,
                    std::to_string(beside) +
                        " samples lie in objects that come from no scan ('thick') and have the value 77"));
}

TEST(ScanOf, WarnsThatAnExpressionHoldsNothing) {
  const ScratchFolder folder;
  const std::string head = R"({"id": "head", "do": "window", "scan": "ct", "low": -30000})";
  EXPECT_TRUE(warns(evaluate(ball_plan(folder, scan_of(head, "head & ~head"))),
                    "no sample of the scan lies in 'head & ~head'"));
  EXPECT_FALSE(warns(evaluate(ball_plan(folder, scan_of(head, "head"))), "no sample of the scan"));
}

TEST(ScanOf, PaddingThatStaysIsNoDifference) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, moved_cap("moved | rest") + R"json(,
          {"id": "seen", "do": "window", "scan": "operated", "low": 0},
          {"id": "again", "do": "scan_of", "scan": "operated", "expression": "seen", "hole_value": -500})json"),
                                         keeping_scans());
  const auto& details = evaluation.scans.back().details;
  EXPECT_GT(details["second_reading"]["compared"], 10000);
  EXPECT_EQ(details["second_reading"]["differing"], 0) << details.dump();
}

TEST(ScanOf, RefusesSamplesOfAnotherMeaning) {
  const ScratchFolder folder;
  const std::string edges = R"({"id": "edges", "do": "marr_hildreth", "scan": "ct", "sigma_mm": 2},
      {"id": "edge", "do": "window", "scan": "edges", "low": 1})";
  try {
    evaluate(ball_plan(folder, scan_of(edges, "ball | edge")));
    FAIL() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("those of 'ct'"), std::string::npos) << error.what();
  }
}

TEST(ScanOf, BadInputIsRefused) {
  const ScratchFolder folder;
  EXPECT_NE(ball_refusal(folder, moved_cap("moved | nothing")).find("nothing"), std::string::npos);
  EXPECT_NE(ball_refusal(folder, moved_cap("moved |")).find("expression"), std::string::npos);
  EXPECT_NE(
      ball_refusal(folder, R"({"id": "f", "do": "scan_file", "scan": "ct", "path": "a.png"})").find(".nrrd"),
      std::string::npos);
}

}  // namespace
}  // namespace octotomy::planner
