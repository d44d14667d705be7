// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Fragments of the head phantom, cut and moved by random plans, as decks.
#include <cstdlib>
#include <gtest/gtest.h>

#include "convert/tet/tetrahedralise.h"
#include "planner/plan/plan_results.h"
#include "planner/plan/random_plan.h"
#include "planner/plan/sha256.h"
#include "tests/convert/surfaces.h"
#include "tests/file_bytes.h"
#include "tests/planner/ball_scan.h"
#include "verify/phantom/head_phantom.h"

namespace octotomy::planner {
namespace {

/// The number of fragments that the long run requests, or a few.
int wanted_fragments() {
  const char* asked = std::getenv("OCTOTOMY_FRAGMENTS");
  return asked == nullptr ? 2 : std::atoi(asked);
}

Plan with_deck(const RandomPlan& random, const std::filesystem::path& folder) {
  Json json = Json::parse(text(random));
  json["steps"].push_back({{"id", "deck"},
                           {"do", "export"},
                           {"object", json["steps"].back()["id"]},
                           {"path", "piece.vtu"},
                           {"fallback", true}});
  return parse_plan(json.dump(), folder);
}

Exported deck_of(const Plan& plan, const Evaluation& evaluation, const std::filesystem::path& folder) {
  std::filesystem::create_directory(folder);
  Timings timings;
  return write_files(plan, evaluation, folder, timings).back();
}

TEST(FragmentDecks, RandomFragmentsOfTheHeadAllBecomeDecksWithoutAnInvertedElement) {
  const tests::ScratchFolder folder;
  verify::HeadOptions head;
  head.voxel_mm = std::getenv("OCTOTOMY_FRAGMENTS") == nullptr ? 16.0 : 10.0;
  voxel::write_scene(verify::head_phantom(head), folder / "head.nrrd");
  const std::vector<RandomScan> scans{{"head", folder / "head.nrrd", 200.0, 400.0}};
  EvaluateOptions uncertified;
  uncertified.certify = false;

  constexpr std::uint64_t least_voxels = 50;  // under which it is no fragment but a crumb
  int fragments = 0, by_meshers = 0, by_fallback = 0;
  for (std::uint64_t seed = 0; fragments < wanted_fragments(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ASSERT_LT(seed, 20U * static_cast<unsigned>(wanted_fragments()) + 100U) << "plans leave no fragments";
    verify::Random random(seed);
    const Plan plan = with_deck(random_plan(random, scans), folder.path());
    Evaluation evaluation;
    try {
      evaluation = evaluate(plan, uncertified);
    } catch (const std::runtime_error&) {
      continue;  // a window or mask without a voxel
    }
    if (evaluation.objects.back().voxel.octree.voxel_count() < least_voxels) continue;
    ++fragments;
    const Exported deck = deck_of(plan, evaluation, folder / "out");
    ASSERT_TRUE(deck.written) << testing::PrintToString(deck.findings);
    EXPECT_GT(deck.details["quality"]["min_volume_mm3"].get<double>(), 0.0);
    EXPECT_GE(deck.details["quality"]["min_dihedral_deg"].get<double>(), convert::fit_dihedral_deg());
    EXPECT_GT(std::filesystem::file_size(folder / "out" / "piece.vtu"), 0U);
    const bool fallback = deck.details["fallback"].get<bool>();
    EXPECT_EQ(fallback, deck.details["method"] == "octree");

    if (fallback) {
      EXPECT_EQ(deck.findings.front().substr(0, 9), "fallback:");
    }
    ++(fallback ? by_fallback : by_meshers);
    std::cout << "seed " << seed << ": " << deck.content << ", " << deck.details["method"]
              << (fallback ? ", " + deck.findings.front() : "") << std::endl;
  }
  std::cout << fragments << " fragments, " << by_meshers << " by meshers, " << by_fallback
            << " by the fallback\n";
  EXPECT_GT(by_meshers, fragments / 2);
}

/// A folder with a ball's scan, and plans that write it, or its upper half, as a deck.
class BallFolder {
 public:
  BallFolder() { voxel::write_scene(tests::ball_scene(10.0, 32), folder_ / "ball.nrrd"); }

  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

  /// `keys` end the export step.
  Plan plan(const std::string& keys) const { return plan_of("", "ball", keys); }
  Plan plan_of_half(const std::string& keys) const {
    return plan_of(R"({ "id": "cut", "do": "mask", "regions": [ { "view": "anterior",
                     "polygons_mm": [[[-20, 0], [20, 0], [20, 20], [-20, 20]]] } ] },
                 { "id": "upper", "do": "combine", "expression": "ball & cut" },
                 { "id": "lower", "do": "combine", "expression": "ball - cut" },)",
                   "upper", keys);
  }

 private:
  Plan plan_of(const std::string& steps, const std::string& object, const std::string& keys) const {
    return parse_plan(R"({ "octotomy_plan": 1, "name": "ball", "scans": { "ct": { "path": "ball.nrrd" } },
      "steps": [ { "id": "ball", "do": "window", "scan": "ct", "low": 0 }, )" +
                          steps + R"({ "id": "deck", "do": "export", "object": ")" + object + "\", " + keys +
                          " } ] }",
                      folder_.path());
  }

  tests::ScratchFolder folder_;
};

TEST(FragmentDecks, AnObjectWithoutAMeshIsWrittenByTheFallbackOnlyWhereTheStepAllowsIt) {
  const BallFolder folder;
  const Plan with = folder.plan(R"("path": "ball.inp", "fallback": true)"),
             without = folder.plan(R"("path": "ball.inp")");
  Evaluation evaluation = evaluate(with);
  EXPECT_FALSE(deck_of(with, evaluation, folder / "out").details["fallback"].get<bool>());
  evaluation.objects.change(0).mesh.within.reset();
  EXPECT_FALSE(deck_of(without, evaluation, folder / "out").written);
  const Exported deck = deck_of(with, evaluation, folder / "out");
  ASSERT_TRUE(deck.written);
  EXPECT_TRUE(deck.details["fallback"].get<bool>());
  EXPECT_NEAR(deck.details["volume_mm3"].get<double>(),
              static_cast<double>(evaluation.objects.front().voxel.octree.voxel_count()), 1e-6);
  const std::string header = tests::bytes_of(folder / "out/ball.inp");
  EXPECT_NE(header.find("fallback: it has no mesh"), std::string::npos) << "the deck itself says so";
  EXPECT_NE(header.find("SHA-256 " + sha256_of(with.text)), std::string::npos);
  EXPECT_NE(header.find("scan ct: SHA-256 " + sha256_of_path(folder / "ball.nrrd")), std::string::npos);
  EXPECT_NE(header.find("radius-edge ratio up to"), std::string::npos);
}

TEST(FragmentDecks, AStepOfOrderTwoWritesElementsOfTenNodes) {
  const BallFolder folder;
  for (const std::string order : {"1", "2"}) {
    const Plan the = folder.plan(R"("path": "ball.inp", "order": )" + order);
    ASSERT_TRUE(deck_of(the, evaluate(the), folder / "out").written);
    const std::string text = tests::bytes_of(folder / "out/ball.inp");
    EXPECT_NE(text.find(order == "1" ? "TYPE=C3D4," : "TYPE=C3D10,"), std::string::npos) << order;
  }
  EXPECT_THROW(folder.plan(R"("path": "ball.inp", "order": 3)"), std::runtime_error);
  EXPECT_THROW(folder.plan(R"("path": "ball.stl", "order": 2)"), std::runtime_error);
  EXPECT_THROW(folder.plan(R"("path": "ball.node", "order": 2)"), std::runtime_error);
}

TEST(FragmentDecks, AStopEndsAFillingOfEveryKindAndLeavesNoDeck) {
  const BallFolder folder;
  std::filesystem::create_directory(folder / "out");
  std::stop_source source;
  source.request_stop();
  for (const char* keys : {"", R"(, "fallback": true)", R"(, "regions": ["lower"])",
                           R"(, "regions": ["lower"], "smooth_mm": 2.5)", R"(, "fixed": ["lower"])"}) {
    const Plan plan = folder.plan_of_half(R"("path": "ball.inp")" + std::string(keys));
    const Evaluation evaluation = evaluate(plan);
    Timings timings;
    EXPECT_THROW(write_files(plan, evaluation, folder / "out", timings, {source.get_token(), {}}), Stopped)
        << keys;
    EXPECT_FALSE(std::filesystem::exists(folder / "out/ball.inp")) << keys;
  }
}

TEST(FragmentDecks, BegunAheadAreTheSameFilesAndReasons) {
  const BallFolder folder;
  // For several regions, nothing is prepared in advance.
  for (const char* keys : {R"("path": "ball.inp")", R"("path": "ball.vtu", "fallback": true)",
                           R"("path": "ball.inp", "regions": ["lower"])"}) {
    const Plan plan = folder.plan_of_half(keys);
    std::vector<Exported> made;
    for (const bool ahead : {false, true}) {
      EvaluateOptions options;
      options.prepares_files = ahead;
      const Evaluation evaluation = evaluate(plan, options);
      EXPECT_EQ(evaluation.file_preparations.size(), ahead ? 1u : 0u) << keys;
      made.push_back(deck_of(plan, evaluation, folder / (ahead ? "ahead" : "after")));
    }
    EXPECT_EQ(made[0].written, made[1].written) << keys;
    EXPECT_EQ(made[0].findings, made[1].findings) << keys;
    EXPECT_EQ(made[0].details, made[1].details) << keys;
    if (made[0].written && made[1].written) {
      EXPECT_EQ(tests::bytes_of(folder / "after" / made[0].path),
                tests::bytes_of(folder / "ahead" / made[1].path))
          << keys;
    }
  }
}

TEST(FragmentDecks, BegunAheadShareOneFillingAndTellItsProgressAndTime) {
  const BallFolder folder;
  const Plan plan = folder.plan_of_half(
      R"("path": "ball.inp" }, { "id": "again", "do": "deck", "object": "upper", "path": "ball.vtu")");
  EvaluateOptions options;
  options.prepares_files = true;
  const Evaluation evaluation = evaluate(plan, options);
  ASSERT_EQ(evaluation.file_preparations.size(), 2u);
  EXPECT_EQ(evaluation.file_preparations.at("deck"), evaluation.file_preparations.at("again"));
  std::filesystem::create_directory(folder / "out");
  Timings timings;
  const std::vector<Exported> files = write_files(plan, evaluation, folder / "out", timings);
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(files[0].details["tets"], files[1].details["tets"]);
  EXPECT_GT(timings["tetrahedralise"], 0.0);
  Timings written_again;
  std::filesystem::create_directory(folder / "again");
  write_files(plan, evaluation, folder / "again", written_again);
  EXPECT_EQ(written_again.count("tetrahedralise"), 0u);
}

TEST(FragmentDecks, BegunAheadEndWithTheEvaluationOrTheStop) {
  const BallFolder folder;
  const Plan plan = folder.plan_of_half(R"("path": "ball.inp")");
  std::filesystem::create_directory(folder / "out");
  std::stop_source source;
  EvaluateOptions options{source.get_token(), {}};
  options.prepares_files = true;
  const Evaluation evaluation = evaluate(plan, options);
  evaluate(plan, options);  // begins a filling that nobody wants
  source.request_stop();
  Timings timings;
  EXPECT_THROW(write_files(plan, evaluation, folder / "out", timings, {source.get_token(), {}}), Stopped);
  EXPECT_TRUE(std::filesystem::is_empty(folder / "out"));
}

TEST(FragmentDecks, ElementsTooFlatForASolverAreToldOrGiveWayToTheFallback) {
  const BallFolder folder;
  const Plan with = folder.plan(R"("path": "ball.inp", "fallback": true)"),
             without = folder.plan(R"("path": "ball.inp")");
  Evaluation evaluation = evaluate(with);
  // A plate of a hundredth of a voxel: no mesher can make good elements of it.
  evaluation.objects.change(0).mesh.within = brep::solid_of(tests::box({-10, -10, 0}, {10, 10, 0.01}));
  const Exported kept = deck_of(without, evaluation, folder / "out");
  ASSERT_TRUE(kept.written) << testing::PrintToString(kept.findings);
  EXPECT_LT(kept.details["quality"]["min_dihedral_deg"].get<double>(), convert::fit_dihedral_deg());
  EXPECT_NE(kept.findings.back().find("a solver needs"), std::string::npos) << kept.findings.back();
  const Exported deck = deck_of(with, evaluation, folder / "out");
  ASSERT_TRUE(deck.written);
  EXPECT_TRUE(deck.details["fallback"].get<bool>());
  EXPECT_NE(deck.findings.front().find("a solver needs"), std::string::npos) << deck.findings.front();
  EXPECT_EQ(deck.findings.back().substr(0, 8), "before: ") << deck.findings.back();
  EXPECT_GT(deck.details["quality"]["min_dihedral_deg"].get<double>(), convert::fit_dihedral_deg());
}

TEST(FragmentDecks, RegionsShareTheirNodesAndOverlapsBelongToTheFirst) {
  const BallFolder folder;
  const auto plan = [&](const std::string& keys) {
    return folder.plan_of_half(R"("path": "ball.inp", )" + keys);
  };
  const Plan halves = plan(R"("regions": ["lower"])");
  const Evaluation evaluation = evaluate(halves);
  const Exported deck = deck_of(halves, evaluation, folder / "out");
  ASSERT_TRUE(deck.written);
  EXPECT_EQ(deck.details["regions"].get<int>(), 2);
  EXPECT_GT(deck.details["surfaces"]["upper_TO_lower"].get<int>(), 100);
  EXPECT_NEAR(deck.details["volume_mm3"].get<double>(),
              static_cast<double>(evaluation.object("ball").voxel.octree.voxel_count()), 1e-6);

  const Plan overlap = plan(R"("regions": ["ball"])");
  const Exported with_overlap = deck_of(overlap, evaluation, folder / "out");
  ASSERT_TRUE(with_overlap.written);
  EXPECT_NE(with_overlap.findings[1].find("overlap"), std::string::npos) << with_overlap.findings[1];
  EXPECT_EQ(with_overlap.details["volume_mm3"], deck.details["volume_mm3"]);

  const Plan smooth = plan(R"("regions": ["lower"], "smooth_mm": 2.5, "between": "contact", "materials":
      { "lower": { "youngs_modulus_mpa": 0.5, "poisson_ratio": 0.4 } })");
  const Exported apart = deck_of(smooth, evaluation, folder / "out");
  ASSERT_TRUE(apart.written) << testing::PrintToString(apart.findings);
  EXPECT_EQ(apart.details["method"], "Mesh_3 of labels");
  EXPECT_EQ(apart.details["contacts"], 1);
  EXPECT_FALSE(apart.details["fallback"].get<bool>());
  EXPECT_GT(apart.details["quality"]["min_dihedral_deg"].get<double>(), convert::fit_dihedral_deg());
  EXPECT_EQ(apart.details["surfaces"]["upper_TO_lower"], apart.details["surfaces"]["lower_TO_upper"]);
  // Discs of radius r whose rims lie on a sphere of radius R lie r^2 / (4 R) below it on the mean.
  const double chord_mm = 2.5 * 2.5 / (4.0 * 10.0);
  EXPECT_NEAR(apart.details["volume_mm3"].get<double>() / deck.details["volume_mm3"].get<double>(), 1.0,
              3.0 * chord_mm / 10.0);
  const std::string text = tests::bytes_of(folder / "out/ball.inp");
  EXPECT_NE(text.find("*MATERIAL, NAME=OF_lower\n*ELASTIC\n0.5, 0.4"), std::string::npos);
  EXPECT_NE(text.find("lower_TO_upper, upper_TO_lower\n"), std::string::npos)
      << "the softer one is the slave";

  for (const char* keys :
       {R"("regions": ["lower"], "between": "glued")", R"("smooth_mm": 2)",
        R"("regions": ["lower"], "smooth_mm": 0)", R"("regions": ["lower"], "materials": { "ball": {} })",
        R"("regions": ["lower"], "materials": { "lower": { "youngs_modulus_mpa": 1 } })"})
    EXPECT_THROW(plan(keys), std::runtime_error) << keys;
  EXPECT_THROW(plan(R"("regions": ["nothing"])"), std::runtime_error);
  EXPECT_THROW(plan(R"("regions": ["lower"], "fallback": true)"), std::runtime_error);
}

}  // namespace
}  // namespace octotomy::planner
