// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/plan/object_cache.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <gtest/gtest.h>

#include "planner/operation/measure/result_json.h"
#include "tests/planner/operation/ball_operation.h"

namespace octotomy::planner {
namespace {

using namespace tests;

std::string steps(double up_mm) {
  return R"({"id": "cut", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-30, 5], [30, 5], [30, 30], [-30, 30]]]}]},
      {"id": "cap", "do": "combine", "expression": "ball & cut"},
      {"id": "moved", "do": "move", "object": "cap", "translate_mm": [0, 0, )" +
         std::to_string(up_mm) + "]}";
}

std::string text_of(const Evaluation& evaluation) {
  std::string text;
  for (const Object& object : evaluation.objects) {
    Json json = to_json(object);
    text += json.dump();
    if (object.certificate) {
      Json certificate = to_json(*object.certificate);
      certificate.erase("timings_ms");
      text += certificate.dump();
    }
  }
  return text;
}

TEST(ObjectCache, AReplayTakesEveryAnswerAndTellsTheSame) {
  const ScratchFolder folder;
  ObjectCache cache;
  EvaluateOptions options;
  options.cache = &cache;
  const std::string first = text_of(evaluate(ball_plan(folder, steps(2)), options));
  EXPECT_EQ(cache.counts().found, 0u);
  const std::string again = text_of(evaluate(ball_plan(folder, steps(2)), options));
  EXPECT_EQ(cache.counts().found, 5u) << "one scan, four objects";
  EXPECT_EQ(again, first);
  EXPECT_EQ(text_of(evaluate(ball_plan(folder, steps(2)))), first) << "as without a cache";
}

TEST(ObjectCache, AChangedLastStepIsTheOnlyOneThatIsMade) {
  const ScratchFolder folder;
  ObjectCache cache;
  EvaluateOptions options;
  options.cache = &cache;
  evaluate(ball_plan(folder, steps(2)), options);
  const std::size_t missed = cache.counts().missed;
  const Evaluation changed = evaluate(ball_plan(folder, steps(3)), options);
  EXPECT_EQ(cache.counts().missed, missed + 1);
  EXPECT_EQ(text_of(changed), text_of(evaluate(ball_plan(folder, steps(3)))));
}

TEST(ObjectCache, OfAPlanOfThirtyStepsTheLastMotionAloneIsMade) {
  // OCTOTOMY_SIDE=512 tells the time at that size.
  const char* asked = std::getenv("OCTOTOMY_SIDE");
  const int side = asked != nullptr ? std::atoi(asked) : 64;
  const ScratchFolder folder;
  voxel::write_scene(ball_scene(ball_radius_mm), folder / "ball.nrrd");
  const auto plan = [&](double up_mm) {
    nlohmann::json steps =
        nlohmann::json::array({{{"id", "s0"}, {"do", "window"}, {"scan", "ct"}, {"low", 0}}});
    for (int step = 1; step < 29; step += 2) {
      const std::string before = "s" + std::to_string(step - 1), moved = "s" + std::to_string(step);
      steps.push_back(
          {{"id", moved}, {"do", "move"}, {"object", before}, {"translate_mm", {0.25, 0, 0.125}}});
      steps.push_back({{"id", "s" + std::to_string(step + 1)},
                       {"do", "combine"},
                       {"expression", before + " & " + moved}});
    }
    steps.push_back({{"id", "last"},
                     {"do", "move"},
                     {"object", "s0"},
                     {"translate_mm", {0, 0, up_mm}},
                     {"rotate", {{"degrees", up_mm}, {"axis", {1, 0, 0}}}}});
    return parse_plan(nlohmann::json{{"octotomy_plan", 1},
                                     {"name", "long"},
                                     {"scans", {{"ct", {{"path", "ball.nrrd"}}}}},
                                     {"universe", {{"voxel_mm", 64.0 / side}}},
                                     {"steps", steps}}
                          .dump(),
                      folder.path());
  };
  ObjectCache cache;
  EvaluateOptions options;
  options.cache = &cache;
  options.certify = options.meshes = false;
  ASSERT_EQ(plan(1).steps.size(), 30u);
  evaluate(plan(1), options);
  const std::size_t missed = cache.counts().missed;
  const Plan changed = plan(2);
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  const Evaluation evaluation = evaluate(changed, options);
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(cache.counts().missed, missed + 1);
  EXPECT_EQ(evaluation.universe.side(), side);
  if (asked != nullptr)
    std::printf("the last motion of 30 steps at %d^3: %.1f ms, of the processors %.1f ms\n", side,
                took.count(), 1000.0 * static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
}

TEST(ObjectCache, AnotherScanInItsPlaceIsReadAnew) {
  const ScratchFolder folder;
  ObjectCache cache;
  EvaluateOptions options;
  options.cache = &cache;
  const Plan plan = ball_plan(folder, steps(2));
  const double before = evaluate(plan, options).object("ball").voxel.measures.volume_mm3;
  voxel::write_scene(ball_scene(15.0), folder / "ball.nrrd");
  std::filesystem::last_write_time(
      folder / "ball.nrrd", std::filesystem::last_write_time(folder / "ball.nrrd") + std::chrono::seconds(2));
  const double after = evaluate(plan, options).object("ball").voxel.measures.volume_mm3;
  EXPECT_LT(after, 0.5 * before);
}

TEST(ObjectCache, AnAnswerWithoutMeshesIsNoneWithThem) {
  const ScratchFolder folder;
  ObjectCache cache;
  EvaluateOptions options;
  options.cache = &cache;
  options.meshes = false;
  const Plan plan = ball_plan(folder, steps(2));
  const Evaluation quick = evaluate(plan, options);
  EXPECT_FALSE(quick.object("moved").mesh.whole);
  options.meshes = true;
  const Evaluation whole = evaluate(plan, options);
  EXPECT_TRUE(whole.object("moved").mesh.whole);
  EXPECT_TRUE(whole.object("moved").voxel.octree == quick.object("moved").voxel.octree);
}

TEST(ObjectCache, TheOneUsedLongestAgoGoesFirst) {
  ObjectCache cache(2);
  const Object object("a", "window", voxel::Universe{});
  cache.keep("1", object);
  cache.keep("2", object);
  EXPECT_TRUE(cache.object("1"));
  cache.keep("3", object);
  EXPECT_TRUE(cache.object("1"));
  EXPECT_FALSE(cache.object("2"));
}

TEST(ObjectCache, AnswersOfManyBytesMakeRoomForEachOther) {
  const ScratchFolder folder;
  const Evaluation evaluation = evaluate(ball_plan(folder, steps(5.0)));
  const Object& object = evaluation.object("ball");
  const std::uint64_t bytes = ObjectCache::bytes_of(object);
  EXPECT_GT(bytes, 36 * object.mesh.within->triangles().faces.size() + bytes_memory(object.voxel.octree));
  ObjectCache cache(512, 2 * bytes);
  for (const char* key : {"1", "2", "3"}) cache.keep(key, object);
  EXPECT_FALSE(cache.object("1"));
  EXPECT_TRUE(cache.object("2"));
  EXPECT_TRUE(cache.object("3"));
  // The newest stays, however large.
  ObjectCache narrow(512, bytes / 2);
  narrow.keep("1", object);
  EXPECT_TRUE(narrow.object("1"));
  narrow.keep("2", object);
  EXPECT_FALSE(narrow.object("1"));
  EXPECT_TRUE(narrow.object("2"));
}

}  // namespace
}  // namespace octotomy::planner
