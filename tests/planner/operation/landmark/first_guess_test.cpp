// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/landmark/first_guess.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <map>

#include "brep/mesh/move.h"
#include "convert/surface/isosurface.h"
#include "planner/operation/table/plan_universe.h"
#include "tests/reference_data.h"
#include "verify/phantom/head_phantom.h"
#include "voxel/scan/read_scene.h"
#include "voxel/solid/combine.h"

namespace octotomy::planner {
namespace {

constexpr double bone_hu = 300.0;

struct Skull {
  voxel::DrawnObject drawn;
  brep::Mesh surface;
};

/// A scan's bone where a rigid motion brings it.
Skull skull_of(const voxel::Scene& scene, const glm::dmat4& motion = glm::dmat4(1.0)) {
  const voxel::GreyOctree grey = voxel::grey_octree_of(universe_of(scene.lattice, 1.5), scene);
  const voxel::Expression bone(voxel::Window{grey, bone_hu, std::numeric_limits<double>::infinity()});
  Skull skull{{"skull", voxel::Octree::empty({})}, {}};
  const bool is_still = motion == glm::dmat4(1.0);
  skull.drawn.octree = voxel::combine(grey.universe(), is_still ? bone : moved(bone, motion));
  skull.drawn.grey = grey;
  skull.drawn.threshold = bone_hu;
  if (!is_still) skull.drawn.moved_from_still = motion;
  brep::Triangles triangles = convert::isosurface(grey, bone_hu, std::numeric_limits<double>::infinity());
  for (glm::dvec3& p : triangles.points_mm) p = glm::dvec3(motion * glm::dvec4(p, 1.0));
  skull.surface = brep::mesh_of(triangles);
  return skull;
}

const voxel::Scene& head() {
  static const voxel::Scene scene = verify::head_phantom();
  return scene;
}
const SkullGuess& guess_of_head() {
  static const SkullGuess guess = [] {
    const Skull skull = skull_of(head());
    return guess_landmarks(skull.drawn, skull.surface);
  }();
  return guess;
}

std::map<std::string, LandmarkGuess> by_name(const SkullGuess& guess) {
  std::map<std::string, LandmarkGuess> named;
  for (const LandmarkGuess& one : guess.found) named.emplace(one.name, one);
  return named;
}

/// The closed form's point near the mid-plane that lies farthest along a direction, in a window of (y, z).
glm::dvec3 farthest(const glm::dvec2& low, const glm::dvec2& high, const glm::dvec3& direction) {
  glm::dvec3 best(0.0);
  double most = -std::numeric_limits<double>::infinity();
  for (double y = low.x; y <= high.x; y += 0.1)
    for (double z = low.y; z <= high.y; z += 0.1) {
      // The two central incisors do not quite meet.
      for (const double x : {0.0, 1.5}) {
        const glm::dvec3 p(x, y, z);
        if (glm::dot(p, direction) <= most || !verify::head_contains(verify::HeadPart::Bone, p)) continue;
        most = glm::dot(p, direction);
        best = {0.0, y, z};
      }
    }
  return best;
}

TEST(FirstGuess, FindsExtremalPointsOfTheClosedForm) {
  const auto found = by_name(guess_of_head());
  const auto near = [&](const char* name, const glm::dvec3& truth) {
    ASSERT_TRUE(found.contains(name)) << name;
    const LandmarkGuess& one = found.at(name);
    EXPECT_LE(glm::distance(one.p_mm, truth), one.within_mm + 1.5) << name << " within " << one.within_mm;
    EXPECT_LE(one.within_mm, 5.0) << name;
  };
  near("pogonion", farthest({-100, -102}, {-80, -86}, {0, -1, 0}));
  near("menton", farthest({-95, -110}, {-60, -95}, {0, 0, -1}));
  // The lowest of the upper incisors, whose gap to the lower ones is some millimetres high.
  near("incisor", farthest({-90, -59.5}, {-75, -50}, {0, 0, -1}));
  near("lower_incisor", farthest({-90, -75}, {-75, -59.5}, {0, 0, 1}));
}

TEST(FirstGuess, TellsBothSidesOfASymmetricHeadAlike) {
  const auto found = by_name(guess_of_head());
  for (const char* name : {"orbitale", "zygoma", "piriform"}) {
    const std::string left = std::string(name) + "_left", right = std::string(name) + "_right";
    ASSERT_TRUE(found.contains(left) && found.contains(right)) << name;
    const glm::dvec3 mirrored = found.at(right).p_mm * glm::dvec3(-1, 1, 1);
    EXPECT_LE(glm::distance(found.at(left).p_mm, mirrored), 4.5) << name;
    EXPECT_GT(found.at(left).p_mm.x, 0.0) << name;
  }
}

TEST(FirstGuess, GivesAReasonForWhatItDoesNotFind) {
  EXPECT_FALSE(guess_of_head().missing.empty());
  const auto found = by_name(guess_of_head());
  for (const auto& [name, why] : guess_of_head().missing) {
    EXPECT_FALSE(found.contains(name)) << name;
    EXPECT_GT(why.size(), 10u) << name;
  }
}

TEST(FirstGuess, GoesWithAHeadThatIsTurnedAndShifted) {
  glm::dmat4 motion = glm::translate(glm::dmat4(1.0), {6, -4, 5});
  motion = glm::rotate(motion, glm::radians(8.0), {0, 0, 1});
  motion = glm::rotate(motion, glm::radians(-6.0), {0, 1, 0});
  motion = glm::rotate(motion, glm::radians(4.0), {1, 0, 0});
  const Skull skull = skull_of(head(), motion);
  const auto still = by_name(guess_of_head()), turned = by_name(guess_landmarks(skull.drawn, skull.surface));
  int compared = 0;
  for (const auto& [name, one] : still) {
    const auto other = turned.find(name);
    if (other == turned.end() || name.starts_with("midline_")) continue;
    const glm::dvec3 expected = glm::dvec3(motion * glm::dvec4(one.p_mm, 1.0));
    EXPECT_LE(glm::distance(other->second.p_mm, expected), one.within_mm + other->second.within_mm) << name;
    ++compared;
  }
  EXPECT_GE(compared, 12);
  // Points of the mid-line lie in the turned mid-plane.
  const glm::dvec3 normal = glm::dvec3(motion * glm::dvec4(1, 0, 0, 0));
  for (const char* name : {"midline_front", "midline_back", "midline_top"}) {
    ASSERT_TRUE(turned.contains(name));
    const glm::dvec3 off = turned.at(name).p_mm - glm::dvec3(motion[3]);
    EXPECT_LE(std::abs(glm::dot(off, normal)), turned.at(name).within_mm + 0.5) << name;
  }
}

TEST(FirstGuess, LeavesTheMandibleOutWhereThereIsNone) {
  Skull skull = skull_of(head());
  skull.drawn.octree =
      voxel::combine(skull.drawn.octree.universe(),
                     voxel::Expression(skull.drawn.octree) - voxel::Box{{-200, -200, -200}, {200, -20, -59}});
  const SkullGuess guess = guess_landmarks(skull.drawn, skull.surface);
  const auto found = by_name(guess);
  for (const char* name : {"menton", "pogonion", "lower_incisor", "gonion_left", "gonion_right"})
    EXPECT_FALSE(found.contains(name)) << name;
  EXPECT_TRUE(found.contains("ans"));
  EXPECT_TRUE(found.contains("orbitale_left"));
}

// A real head with metal in its teeth, whose landmarks were set by hand in pictures of 1 mm pixels; its
// slices are 2 mm apart.
TEST(FirstGuessOfARealHead, FindsPointsWhereAPersonSetThem) {
  OCTOTOMY_NEEDS_DATA("ct_unc_cthead.nrrd");
  const Skull skull = skull_of(voxel::read_scene(tests::reference_data("ct_unc_cthead.nrrd")));
  const SkullGuess guess = guess_landmarks(skull.drawn, skull.surface);
  const auto found = by_name(guess);
  const std::map<std::string, std::string> missing(guess.missing.begin(), guess.missing.end());
  const std::map<std::string, glm::dvec3> by_hand{
      {"incisor", {-18, -100, 69}},      {"lower_incisor", {-20, -96, 64}},
      {"menton", {-20, -83, 25}},        {"pogonion", {-20, -89, 35}},
      {"piriform_left", {-5, -82, 98}},  {"piriform_right", {-33, -82, 98}},
      {"gonion_left", {27, -20, 48}},    {"gonion_right", {-66, -22, 47}},
      {"zygoma_left", {43, -32, 107}},   {"zygoma_right", {-86, -30, 105}},
      {"orbitale_left", {15, -75, 116}}, {"orbitale_right", {-55, -77, 115}}};
  for (const auto& [name, p_mm] : by_hand) {
    ASSERT_TRUE(found.contains(name)) << name << ": " << missing.at(name);
    EXPECT_LE(glm::distance(found.at(name).p_mm, p_mm), found.at(name).within_mm + 4.0) << name;
  }
}

// The scan ends at the nose. The farthest bone at the side is then that of the temple, 35 mm above the arch.
TEST(FirstGuessOfARealHead, SeeksNoArchFromAFaceThatTheScanCuts) {
  OCTOTOMY_NEEDS_DATA("ct_ge_tilt_variable");
  const Skull skull = skull_of(voxel::read_scene(tests::reference_data("ct_ge_tilt_variable")));
  const SkullGuess guess = guess_landmarks(skull.drawn, skull.surface);
  const auto found = by_name(guess);
  const std::map<std::string, std::string> missing(guess.missing.begin(), guess.missing.end());
  for (const char* name : {"ans", "zygoma_left", "zygoma_right", "gonion_left", "gonion_right"})
    EXPECT_TRUE(missing.contains(name)) << name;
}

TEST(FirstGuess, RefusesWhatIsNoSkull) {
  const voxel::Scene& scene = head();
  Skull skull = skull_of(scene);
  // The skull from behind has the same mid-plane and no face.
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1.0), glm::radians(180.0), glm::dvec3(0, 0, 1));
  skull = skull_of(scene, turned);
  try {
    guess_landmarks(skull.drawn, skull.surface);
    FAIL() << "guessed a face at the back of a head";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("nasal opening"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace octotomy::planner
