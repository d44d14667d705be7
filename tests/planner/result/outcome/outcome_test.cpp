// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/outcome/outcome.h"

#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/planner/ball_scan.h"
#include "verify/phantom/chance.h"
#include "verify/phantom/head_phantom.h"
#include "voxel/scan/write_scene.h"

namespace octotomy::planner {
namespace {

constexpr const char* le_fort_i = R"({"octotomy_plan": 1, "name": "advanced",
  "scans": {"ct": {"path": "head.nrrd"}}, "universe": {"voxel_mm": 2.0},
  "steps": [
    {"id": "marks", "do": "landmarks", "points": [
      {"name": "incisor", "point_mm": [0, -85, -56.5]}, {"name": "menton", "point_mm": [0, -82, -101]}]},
    {"id": "skull", "do": "window", "scan": "ct", "low": 300},
    {"id": "cut", "do": "mask", "regions": [
      {"view": "anterior", "polygons_mm": [[[-40, -58.8], [40, -58.8], [40, -25], [-40, -25]]]},
      {"view": "left", "polygons_mm": [[[-120, -58.8], [-30, -58.8], [-30, -25], [-120, -25]]]}]},
    {"id": "maxilla", "do": "combine", "expression": "skull & cut"},
    {"id": "rest", "do": "combine", "expression": "skull - cut"},
    {"id": "advanced", "do": "move", "object": "maxilla", "translate_mm": [0, -6, 1]}]})";

bool in_cut(const glm::dvec3& p) {
  return std::abs(p.x) < 40 && p.y > -120 && p.y < -30 && p.z > -58.8 && p.z < -25;
}

double sample_at(const voxel::Scene& scan, const glm::dvec3& p_mm) {
  const auto& samples = std::get<voxel::Int16Samples>(scan.samples);
  const glm::dvec3 q = scan.lattice.voxel(p_mm), first = glm::floor(q), t = q - first;
  double value = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner(i & 1, (i >> 1) & 1, i >> 2), weights = glm::mix(1.0 - t, t, corner);
    const glm::ivec3 at(first + corner);
    const bool inside =
        glm::all(glm::greaterThanEqual(at, glm::ivec3(0))) && glm::all(glm::lessThan(at, scan.lattice.dims));
    const std::size_t index =
        static_cast<std::size_t>(at.x) +
        static_cast<std::size_t>(scan.lattice.dims.x) *
            (static_cast<std::size_t>(at.y) +
             static_cast<std::size_t>(scan.lattice.dims.y) * static_cast<std::size_t>(at.z));
    value += weights.x * weights.y * weights.z * (inside ? static_cast<double>(samples[index]) : -1000.0);
  }
  return value;
}

glm::dmat4 motion_by(verify::Chance& chance, double turn_deg, double shift_mm, const glm::dvec3& about) {
  glm::dmat4 motion = glm::translate(
      glm::dmat4(1.0), about + shift_mm * glm::dvec3(chance.even(), chance.even(), chance.even()));
  for (int axis = 0; axis < 3; ++axis)
    motion = glm::rotate(motion, glm::radians(turn_deg * chance.even()), glm::dmat3(1.0)[axis]);
  return glm::translate(motion, -about);
}

/// The head after its maxilla moved by `moved` and the head by `held`, on a lattice of its own, with noise.
voxel::Scene scanned_after(const voxel::Scene& before, const glm::dmat4& moved, const glm::dmat4& held,
                           verify::Chance& chance) {
  voxel::Scene after = before;
  auto& samples = std::get<voxel::Int16Samples>(after.samples);
  const glm::dmat4 unheld = glm::inverse(held), unmoved = glm::inverse(moved);
  std::size_t at = 0;
  for (int z = 0; z < after.lattice.dims.z; ++z)
    for (int y = 0; y < after.lattice.dims.y; ++y)
      for (int x = 0; x < after.lattice.dims.x; ++x) {
        const glm::dvec3 p(after.lattice.lps_from_voxel * glm::dvec4(x, y, z, 1.0));
        const glm::dvec3 q(unheld * glm::dvec4(p, 1.0)), r(unmoved * glm::dvec4(q, 1.0));
        double value = in_cut(q) ? 40.0 : sample_at(before, q);
        if (in_cut(r)) value = std::max(value, sample_at(before, r));
        samples[at++] =
            static_cast<std::int16_t>(std::clamp(value + 25.0 * chance.normal(), -1024.0, 3000.0));
      }
  return after;
}

double difference(const Displacement& a, const Displacement& b, int axis) {
  return axis == 0 ? a.forward_mm - b.forward_mm : axis == 1 ? a.left_mm - b.left_mm : a.up_mm - b.up_mm;
}
double of(const Displacement& a, int axis) {
  return difference(a, {}, axis);
}

/// OCTOTOMY_RUNS=100 makes as many.
TEST(Outcome, AKnownMotionLiesWithinItsInterval) {
  const tests::ScratchFolder folder;
  verify::HeadOptions coarse;
  coarse.voxel_mm = 2.0;
  const voxel::Scene before = verify::head_phantom(coarse);
  voxel::write_scene(before, folder / "head.nrrd");
  const Plan plan = parse_plan(le_fort_i, folder.path());
  EvaluateOptions quick;
  quick.certify = false;
  const Evaluation evaluation = evaluate(plan, quick);
  const char* runs = std::getenv("OCTOTOMY_RUNS");
  int held = 0, cases = 0, runs_held = 0;
  double squared_share = 0.0;
  double widest_mm = 0.0, worst_share = 0.0;
  const int run_count = runs == nullptr ? 2 : std::atoi(runs);
  for (int run = 0; run < run_count; ++run) {
    const int held_before = held, cases_before = cases;
    verify::Chance chance(static_cast<std::uint64_t>(run) + 11);
    const glm::dmat4 planned = evaluation.object("advanced").moved->motion;
    const glm::dmat4 moved = motion_by(chance, 6.0, 4.0, {0, -60, -40}) * planned;
    const glm::dmat4 in_scanner = motion_by(chance, 24.0, 10.0, {0, 0, -10});
    const Outcome outcome = outcome_of(plan, evaluation, scanned_after(before, moved, in_scanner, chance));
    EXPECT_EQ(outcome.unmoved, "rest");
    ASSERT_EQ(outcome.pieces.size(), 1u);
    const PieceOutcome& piece = outcome.pieces.front();
    ASSERT_EQ(piece.points.size(), 2u);
    EXPECT_EQ(piece.points[1].name, "incisor");
    for (const PointOutcome& point : piece.points) {
      const glm::dvec3 p = point.name == "incisor" ? plan.landmarks.front().p_mm
                                                   : *evaluation.object("maxilla").voxel.measures.centroid_mm;
      const Displacement truth = displacement_of(glm::dvec3(moved * glm::dvec4(p, 1.0)) - p, glm::dmat3(1.0));
      for (int axis = 0; axis < 3; ++axis, ++cases) {
        const double error = std::abs(difference(point.achieved, truth, axis));
        if (error <= of(point.half_width, axis)) ++held;
        worst_share = std::max(worst_share, error / of(point.half_width, axis));
        squared_share += std::pow(error / of(point.half_width, axis), 2.0);
        EXPECT_LT(error, 0.25) << run << " " << point.name << " " << axis;
        widest_mm = std::max(widest_mm, of(point.half_width, axis));
      }
    }
    const Turns truth = turns_of(glm::dmat3(moved), glm::dmat3(1.0));
    for (const auto angle : {&Turns::pitch_deg, &Turns::yaw_deg, &Turns::roll_deg}) {
      ++cases;
      if (std::abs(piece.achieved_turns.*angle - truth.*angle) <= piece.turn_half_width.*angle) ++held;
    }
    if (held - held_before == cases - cases_before) ++runs_held;
  }
  RecordProperty("held", held);
  RecordProperty("cases", cases);
  EXPECT_GE(held, std::floor(0.985 * cases));
  RecordProperty("runs_with_all_held", runs_held);
  EXPECT_GE(runs_held, 99 * run_count / 100);
  // Two points of three axes a run.
  RecordProperty("rms_percent_of_half_width",
                 static_cast<int>(100.0 * std::sqrt(squared_share / (6.0 * run_count))));
  RecordProperty("worst_percent_of_half_width", static_cast<int>(100.0 * worst_share));
  RecordProperty("widest_um", static_cast<int>(1000.0 * widest_mm));
  EXPECT_LT(widest_mm, 0.6);
}

TEST(Outcome, RefusesAPlanThatMovesNothingAndAScanWithoutBone) {
  const tests::ScratchFolder folder;
  verify::HeadOptions coarse;
  coarse.voxel_mm = 4.0;
  voxel::Scene before = verify::head_phantom(coarse);
  voxel::write_scene(before, folder / "head.nrrd");
  std::string text = le_fort_i;
  EvaluateOptions quick;
  quick.certify = false;
  const Plan plan = parse_plan(text, folder.path());
  const Evaluation evaluation = evaluate(plan, quick);
  OutcomeOptions high;
  high.low = 30000.0;
  EXPECT_THROW(outcome_of(plan, evaluation, before, high), std::runtime_error);
  text.erase(text.find(",\n    {\"id\": \"advanced\""));
  const Plan still = parse_plan(text + "]}", folder.path());
  EXPECT_THROW(outcome_of(still, evaluate(still, quick), before), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
