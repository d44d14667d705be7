// SPDX-License-Identifier: AGPL-3.0-or-later
// Recommended sizes of plans, of one object in voxels of several sizes and of labels, and of solids by the
// verb.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/measure_file.h"
#include "planner/operation/table/json.h"
#include "planner/plan/evaluate.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/ct_scene.h"
#include "tests/voxel/scratch_folder.h"
#include "verify/phantom/drawn_solid.h"
#include "verify/suite/interval_suite.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// The measurements of "scan.nrrd", and of the same object moved, in a plan of one step.
std::vector<Json> measured(const ScratchFolder& folder, const std::string& step, double voxel_mm) {
  const Plan plan = parse_plan(R"({"octotomy_plan": 1, "name": "one", "scans": {"ct": {"path": "scan.nrrd"}},
      "universe": {"voxel_mm": )" + std::to_string(voxel_mm) +
                                   R"(}, "steps": [{"id": "one", "scan": "ct", )" + step + R"(},
      {"id": "moved", "do": "move", "object": "one", "translate_mm": [3.3, 1, 2],
       "rotate": {"degrees": 20, "axis": [1, 1, 0], "about_mm": [0, 0, 0]}},
      {"id": "size", "do": "measure", "object": "one"},
      {"id": "size_of_moved", "do": "measure", "object": "moved"}]})",
                               folder.path());
  std::vector<Json> found;
  for (const Json& one : measurements_json(plan, evaluate(plan))) found.push_back(one);
  return found;
}

void expect_holds(const Json& found, double truth, const std::string& place) {
  const double value = found["value"], half_width = found["half_width"];
  EXPECT_LE(std::abs(value - truth), half_width) << place << ": " << found << ", truth " << truth;
}

TEST(SizesInPlans, IntervalsGrowWithTheVoxelAndHoldTheTruth) {
  verify::Chance chance(21);
  const verify::DrawnSolid ball{"ball", [](const glm::dvec3& p) { return glm::length(p) - 10.0; }, 11.0,
                                4000.0 / 3.0 * std::numbers::pi, 400.0 * std::numbers::pi};
  const ScratchFolder folder;
  verify::DrawnScan how;
  how.spacing_mm.z = 1.5;
  voxel::write_scene(verify::scan_of(ball, how, chance), folder / "scan.nrrd");
  double volume_width = 0.0, area_width = 0.0;
  for (const double voxel_mm : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    const auto found = measured(folder, R"("do": "window", "low": 500)", voxel_mm);
    ASSERT_EQ(found.size(), 2U);
    const std::string place = std::to_string(voxel_mm) + " mm";
    for (const Json& one : found) {
      expect_holds(one["volume"], ball.volume_mm3, place);
      expect_holds(one["area"], ball.area_mm2, place);
    }
    EXPECT_NEAR(found[0]["volume"]["half_width"].get<double>(),
                found[1]["volume"]["half_width"].get<double>(), 1e-6 * ball.volume_mm3)
        << place;
    EXPECT_GE(found[0]["volume"]["half_width"].get<double>(), volume_width) << place;
    EXPECT_GE(found[0]["area"]["half_width"].get<double>(), area_width) << place;
    volume_width = found[0]["volume"]["half_width"];
    area_width = found[0]["area"]["half_width"];
  }
}

TEST(SizesInPlans, LabelsInThickSlicesHoldTheSolidTheyWereDrawnOf) {
  const double outer = 20.0, inner = 18.5;
  const double truth_mm3 = 4.0 / 3.0 * std::numbers::pi * (std::pow(outer, 3) - std::pow(inner, 3));
  for (const glm::dvec3& spacing_mm :
       {glm::dvec3(0.7, 0.7, 5.0), glm::dvec3(1.0, 1.0, 3.0), glm::dvec3(1.0)}) {
    const glm::ivec3 half(glm::ceil(23.0 / spacing_mm));
    voxel::Scene labels =
        ct_scene(2 * half + 1, spacing_mm, -glm::dvec3(half) * spacing_mm, [&](auto, const glm::dvec3& p) {
          const double r = glm::length(p - glm::dvec3(0.2, 0.1, 0.3));
          return r < outer && r > inner ? 3 : 0;
        });
    labels.meaning = voxel::Meaning::Label;
    labels.modality.clear();
    const ScratchFolder folder;
    voxel::write_scene(labels, folder / "scan.nrrd");
    for (const double voxel_mm : {0.7, 1.0, 2.0})
      for (const Json& one : measured(folder, R"("do": "segment", "label": 3)", voxel_mm))
        expect_holds(one["volume"], truth_mm3,
                     std::to_string(spacing_mm.z) + " mm slices, " + std::to_string(voxel_mm) + " mm voxels");
  }
}

/// The sizes that the verb prints for a scan.
verify::SizeIntervals measured_by_the_verb(const voxel::Scene& scan, double low) {
  Measure asked;
  asked.object = ObjectName{"scan.nrrd"};
  asked.window = SampleWindow{low};
  Timings timings;
  FileBench bench{timings};
  bench.scan_reader = [&scan](const std::filesystem::path&, const voxel::SlicesFinal&) { return scan; };
  const Json json = measure_file(asked, bench).json;
  const auto interval = [&](const char* quantity) {
    return verify::Interval{json.at(quantity).at("value"), json.at(quantity).at("half_width"), {}};
  };
  return {interval("volume"), interval("area"), {}};
}

// Solids of the classes that were not used for calibration, and of the others.
TEST(SizesByTheVerb, HoldSolidsDrawnByChance) {
  verify::IntervalSuiteOptions options;
  options.solids = 81;
  options.seed = 2026;
  options.measure = measured_by_the_verb;
  int totals = 0;
  for (const verify::IntervalCoverage& row : verify::drawn_suite(options)) {
    if (!row.group.empty()) continue;
    ++totals;
    EXPECT_TRUE(verify::is_likely(row, verify::least_held))
        << row.quantity << ", " << row.sampling << ": " << row.held << " of " << row.cases;
  }
  EXPECT_EQ(totals, 4);
}

}  // namespace
}  // namespace octotomy::planner
