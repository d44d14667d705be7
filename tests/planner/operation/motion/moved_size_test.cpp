// SPDX-License-Identifier: AGPL-3.0-or-later
// Sizes of objects that moved: each is the still one's, with the still one's interval.
#include <array>
#include <cstdlib>
#include <gtest/gtest.h>

#include "planner/operation/table/json.h"
#include "planner/plan/plan_results.h"
#include "tests/planner/ct_scene.h"
#include "tests/planner/operation/ball_operation.h"
#include "verify/phantom/chance.h"

namespace octotomy::planner {
namespace {

using namespace tests;

/// The number of random motions; OCTOTOMY_MOTIONS in the environment sets a larger one, such as 500.
int motion_count() {
  const char* asked = std::getenv("OCTOTOMY_MOTIONS");
  return asked == nullptr ? 24 : std::max(1, std::atoi(asked));
}

/// An egg with a blurred surface, in slices that are further apart than the samples within them.
void write_egg(const std::filesystem::path& path) {
  voxel::write_scene(ct_scene({48, 48, 24}, {1, 1, 2}, {-23.3, -23.6, -23.1},
                              [](const glm::ivec3& /*at*/, const glm::dvec3& p_mm) {
                                const glm::dvec3 q = (p_mm - glm::dvec3(0.4, 1.1, -2.2)) /
                                                     glm::dvec3(11, 8, 9.5 + 0.05 * p_mm.x);
                                return std::lround(1000.0 * std::tanh(5.0 * (1.0 - glm::length(q))));
                              }),
                     path);
}

/// Below "piece", the lower part of an egg, stand further steps; each object that `moved` names is measured.
Json sizes(const std::string& further, const std::vector<std::string>& moved) {
  const ScratchFolder folder;
  write_egg(folder / "egg.nrrd");
  std::string text = R"({"octotomy_plan": 1, "name": "egg", "scans": {"ct": {"path": "egg.nrrd"}},
      "universe": {"voxel_mm": 1.0}, "steps": [{"id": "egg", "do": "window", "scan": "ct", "low": 0},
      {"id": "low", "do": "mask", "regions": [{"view": "anterior",
        "polygons_mm": [[[-20, 1], [20, 3], [20, -20], [-20, -20]]]}]},
      {"id": "piece", "do": "combine", "expression": "egg & low"},
      {"id": "rest", "do": "combine", "expression": "egg - low"})" +
                     further;
  for (const std::string& name : moved)
    text += R"(, {"id": "size_)" + name + R"(", "do": "measure", "object": ")" + name + "\"}";
  const Plan plan = parse_plan(text + "]}", folder.path());
  return measurements_json(plan, evaluate(plan));
}

/// The label 1 of a map in which it is a ball of 12 mm about (0.3, 0.3, 0.3), below which stand further
/// steps. Each object that `moved` names is measured.
Json label_sizes(const std::string& further, const std::vector<std::string>& moved) {
  const ScratchFolder folder;
  voxel::Scene labels = ct_scene(glm::ivec3(48), glm::dvec3(1.0), glm::dvec3(-23.0),
                                 [](const glm::ivec3& /*at*/, const glm::dvec3& p_mm) {
                                   return glm::length(p_mm - 0.3) <= 12.0 ? 1 : 0;
                                 });
  labels.meaning = voxel::Meaning::Label;
  labels.modality.clear();
  voxel::write_scene(labels, folder / "label.nrrd");
  std::string text =
      R"({"octotomy_plan": 1, "name": "ball", "scans": {"map": {"path": "label.nrrd"}},
      "universe": {"voxel_mm": 1.0}, "steps": [{"id": "ball", "do": "segment", "scan": "map", "label": 1})" +
      further;
  for (const std::string& name : moved)
    text += R"(, {"id": "size_)" + name + R"(", "do": "measure", "object": ")" + name + "\"}";
  const Plan plan = parse_plan(text + "]}", folder.path());
  return measurements_json(plan, evaluate(plan));
}

void expect_same_size(const Json& found, const Json& still) {
  for (const char* key : {"volume", "area"}) {
    const double value = still.at(key).at("value"), half_width = still.at(key).at("half_width");
    EXPECT_NEAR(found.at(key).at("value").get<double>(), value, 1e-7 * value) << found.at("id") << " " << key;
    EXPECT_NEAR(found.at(key).at("half_width").get<double>(), half_width, 0.03 * half_width)
        << found.at("id") << " " << key;
  }
}

std::string triple(const glm::dvec3& p) {
  return "[" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + "]";
}

TEST(MovedSize, IsTheStillOnesAfterMotionsAndMirrorsByChance) {
  const auto by = [](verify::Chance& chance, double far) {
    return glm::dvec3(chance.between(-far, far), chance.between(-far, far), chance.between(-far, far));
  };
  constexpr int of_a_plan = 12;
  for (int first = 0; first < motion_count(); first += of_a_plan) {
    std::string motions;
    std::vector<std::string> names{"piece"};
    for (int i = first; i < std::min(first + of_a_plan, motion_count()); ++i) {
      verify::Chance chance(static_cast<std::uint64_t>(i));
      const std::string name = "m" + std::to_string(i);
      // Every third from the one before, so that motions follow each other.
      const std::string from = i % 3 == 2 && i > first ? names.back() : "piece";
      const glm::dvec3 axis = by(chance, 1.0), to_mm = by(chance, 3.0);
      if (i % 4 == 3)
        motions += R"(, {"id": ")" + name + R"(", "do": "mirror", "object": ")" + from +
                   R"(", "point_mm": )" + triple(to_mm) + R"(, "normal": )" + triple(axis) + "}";
      else
        motions += R"(, {"id": ")" + name + R"(", "do": "move", "object": ")" + from +
                   R"(", "translate_mm": )" + triple(to_mm) + R"(, "rotate": {"degrees": )" +
                   std::to_string(chance.between(-180, 180)) + R"(, "axis": )" + triple(axis) +
                   R"(, "about_mm": [0, 0, -5]}})";
      names.push_back(name);
    }
    const Json all = sizes(motions, names);
    for (std::size_t i = 1; i < all.size(); ++i) expect_same_size(all[i], all[0]);
  }
}

TEST(MovedSize, IsTheStillOnesWhateverStepMovedIt) {
  const Json all = sizes(R"(, {"id": "off", "do": "move", "object": "piece", "translate_mm": [0, 0, -6]},
      {"id": "met", "do": "advance", "object": "off", "against": "rest", "towards": "up"},
      {"id": "shut", "do": "autorotate", "object": "off", "against": "rest", "most_deg": 40,
        "condyles": [[-12, 9, 2], [12, 9, 2]]},
      {"id": "back", "do": "register", "object": "off", "onto": "piece", "overlap": 1},
      {"id": "held", "do": "move", "object": "piece", "by": {"forward_mm": 2, "up_mm": -1}})",
                         {"piece", "off", "met", "shut", "back", "held"});
  for (std::size_t i = 1; i < all.size(); ++i) expect_same_size(all[i], all[0]);
}

TEST(MovedSize, OfALabelIsTheStillOnesThroughMotionsAndMirrors) {
  const Json all = label_sizes(R"(,
      {"id": "turned", "do": "move", "object": "ball",
        "rotate": {"degrees": 30, "axis": [0.3, 1, 0.2], "about_mm": [0, 0, 0]}},
      {"id": "twin", "do": "mirror", "object": "turned", "point_mm": [1, 0, 0], "normal": [1, 0.2, 0]},
      {"id": "again", "do": "move", "object": "twin", "translate_mm": [1.3, -2.2, 0.7]},
      {"id": "out", "do": "move", "object": "again", "translate_mm": [25, 0, 0]},
      {"id": "home", "do": "move", "object": "out", "translate_mm": [-25, 0, 0]})",
                               {"ball", "turned", "twin", "again", "home", "out"});
  // 4 pi 12^2.
  EXPECT_NEAR(all[0].at("area").at("value").get<double>(), 1809.6, 0.02 * 1809.6);
  for (std::size_t i = 1; i < all.size(); ++i) {
    for (const char* key : {"volume", "area"})
      EXPECT_EQ(all[i].at(key), all[0].at(key)) << all[i].at("id") << " " << key;
    // The centroid that was counted after the motion is reported: the centre moved, and some voxels were
    // gained or lost.
    EXPECT_NE(all[i].at("centroid_mm"), all[0].at("centroid_mm")) << all[i].at("id");
  }
  EXPECT_NE(all[1].at("volume_mm3"), all[0].at("volume_mm3")) << "the motion moved whole voxels";
}

TEST(MovedSize, OfAWindowThatLeavesTheScanIsTheWholeWindows) {
  const auto [whole, twin, gone] = [] {
    const ScratchFolder folder;
    const Plan plan = ball_plan(folder, R"(
      {"id": "twin", "do": "mirror", "object": "ball", "point_mm": [1, 0, 0], "normal": [1, 0, 0]},
      {"id": "gone", "do": "move", "object": "ball", "translate_mm": [32, 0, 0]},
      {"id": "size_ball", "do": "measure", "object": "ball"},
      {"id": "size_twin", "do": "measure", "object": "twin"},
      {"id": "size_gone", "do": "measure", "object": "gone"})");
    const Json all = measurements_json(plan, evaluate(plan));
    return std::array<Json, 3>{all[0], all[1], all[2]};
  }();
  expect_same_size(twin, whole);
  expect_same_size(gone, whole);
}

TEST(MovedSize, OfPiecesMovedApartIsTheSumAndNoSurerThanTheLeastSureOfThem) {
  const Json all = sizes(R"(, {"id": "off", "do": "move", "object": "piece", "translate_mm": [2, 0, -3],
        "rotate": {"degrees": 12, "axis": [1, 0, 0]}},
      {"id": "both", "do": "combine", "expression": "rest | off"})",
                         {"piece", "rest", "off", "both"});
  const auto volume = [&](std::size_t i, const char* key) {
    return all[i].at("volume").at(key).get<double>();
  };
  EXPECT_NEAR(volume(3, "value"), volume(0, "value") + volume(1, "value"), volume(0, "half_width"));
  EXPECT_GE(volume(3, "half_width"), std::max(volume(0, "half_width"), volume(1, "half_width")));
  EXPECT_LE(volume(3, "half_width"), 1.5 * (volume(0, "half_width") + volume(1, "half_width")));
}

}  // namespace
}  // namespace octotomy::planner
