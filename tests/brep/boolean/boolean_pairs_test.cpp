// SPDX-License-Identifier: AGPL-3.0-or-later
// Booleans of pairs made at random and of pairs that only touch, in many poses.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "brep/boolean/boolean.h"
#include "brep/contour/tile_sections.h"
#include "brep/io/read_mesh.h"
#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "brep/mesh/move.h"
#include "tests/brep/shapes.h"
#include "tests/reference_data.h"

namespace octotomy::brep {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

glm::dmat4 any_motion(Random& random, double reach) {
  const glm::dvec3 axis(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, 0.1, 1));
  const glm::dvec3 shift(uniform(random, -reach, reach), uniform(random, -reach, reach),
                         uniform(random, -reach, reach));
  return glm::rotate(glm::translate(glm::dmat4(1.0), shift), uniform(random, 0, 6.28), glm::normalize(axis));
}

/// A trunk that forks. Its sections are drawn as wavy contours and tiled by a cost or by overlaying.
Triangles tiled_contours(Random& random) {
  const double waves = 2.0 + static_cast<double>(random() % 4), depth = uniform(random, 0.0, 0.3);
  const double spread = uniform(random, 0.0, 3.5), radius = uniform(random, 1.5, 2.5);
  const auto contour = [&](double x) {
    Contour ring;
    for (int k = 0; k < 24; ++k) {
      const double angle = 2 * std::numbers::pi * k / 24,
                   r = radius * (1.0 + depth * std::sin(waves * angle));
      ring.points_mm.emplace_back(x + r * std::cos(angle), r * std::sin(angle));
    }
    return ring;
  };
  std::vector<Section> sections;
  for (int s = 0; s < 6; ++s) {
    const double apart = spread * s / 5;
    // Twins that would overlap are one contour still.
    if (apart <= radius * (1.0 + depth))
      sections.push_back({-3.0 + 1.2 * s, {contour(0.0)}});
    else
      sections.push_back({-3.0 + 1.2 * s, {contour(-apart), contour(apart)}});
  }
  TileSectionsOptions options;
  constexpr std::array costs = {TileCost::shortest_span, TileCost::least_area, TileCost::greatest_volume,
                                TileCost::least_angle};
  if (const auto cost = random() % 5; cost < 4)
    options.cost = costs[cost];
  else
    options.cost.reset();
  return tile_sections(sections, options).surface;
}

/// A ball, box, turned box, torus, bumpy blob or tiled contours.
Solid any_solid(Random& random) {
  const int kind = static_cast<int>(random() % 6), splits = 2 + static_cast<int>(random() % 2);
  Triangles t;
  if (kind == 0) t = shapes::sphere({0, 0, 0}, uniform(random, 3, 6), splits);
  if (kind == 1 || kind == 2)
    t = shapes::box({-uniform(random, 1, 5), -4, -3}, {4, uniform(random, 1, 5), uniform(random, 1, 5)});
  if (kind == 3) t = shapes::torus(uniform(random, 3, 5), uniform(random, 0.5, 2), 40, 20);
  if (kind == 4) {
    t = shapes::sphere({0, 0, 0}, 1, splits);
    const double a = uniform(random, 0, 3), b = uniform(random, 2, 5);
    for (glm::dvec3& p : t.points_mm) p *= 4.0 + std::sin(b * p.x + a) + 0.8 * std::cos(4 * p.y) * p.z;
  }
  if (kind == 5) t = tiled_contours(random);
  const glm::dmat4 motion = kind == 1 ? glm::translate(glm::dmat4(1.0), glm::dvec3(uniform(random, -3, 3)))
                                      : any_motion(random, 4.0);
  return moved(trusted_solid(t, Proof::Construction), motion);
}

void expect_closed(const Mesh& mesh, const std::string& what) {
  if (mesh.n_faces() == 0) return;
  const Health h = health(mesh, {.self_intersections = false});
  EXPECT_TRUE(h.closed && h.manifold && h.oriented) << what << ": " << h.findings.front();
}

/// Tests 60 pairs, or the number in OCTOTOMY_PAIRS; a single pair with OCTOTOMY_PAIR=number.
TEST(BooleanPairs, VolumesOfRandomPairsAddUp) {
  const char *count_text = std::getenv("OCTOTOMY_PAIRS"), *one_text = std::getenv("OCTOTOMY_PAIR");
  const int count = count_text ? std::atoi(count_text) : 60;
  int cutting = 0, apart = 0;
  for (int pair = one_text ? std::atoi(one_text) : 0; pair < (one_text ? std::atoi(one_text) + 1 : count);
       ++pair) {
    Random random(static_cast<std::uint64_t>(pair));
    const Solid a = any_solid(random), b = any_solid(random);
    const std::string what = "replay with OCTOTOMY_PAIR=" + std::to_string(pair);
    const Booleans results = booleans(a, b);
    ASSERT_TRUE(results.united && results.intersection && results.a_minus_b && results.b_minus_a) << what;
    ASSERT_TRUE(results.residual) << what;
    EXPECT_LE(*results.residual, 1e-9) << what;
    // The identities cannot detect a part on the wrong side; these inequalities can.
    const double of_a = volume_mm3(a), of_b = volume_mm3(b), common = volume_mm3(*results.intersection);
    EXPECT_GE(common, -1e-9) << what;
    EXPECT_LE(common, std::min(of_a, of_b) * (1 + 1e-9)) << what;
    EXPECT_GE(volume_mm3(*results.united), std::max(of_a, of_b) * (1 - 1e-9)) << what;
    expect_closed(*results.united, what + ", union");
    expect_closed(*results.intersection, what + ", intersection");
    expect_closed(*results.a_minus_b, what + ", a - b");
    expect_closed(*results.b_minus_a, what + ", b - a");
    ++(results.intersection->mesh().n_faces() > 0 ? cutting : apart);
  }
  if (!one_text) {
    EXPECT_GT(cutting, count / 3);
    EXPECT_GT(apart, 0);
  }
}

TEST(BooleanPairs, TheOrderOfTheOperandsDoesNotShowInTheBits) {
  for (std::uint64_t pair = 0; pair < 12; ++pair) {
    Random random(1000 + pair);
    const Solid a = any_solid(random), b = any_solid(random);
    const Booleans ab = booleans(a, b), ba = booleans(b, a);
    const auto same = [&](const std::optional<Solid>& one, const std::optional<Solid>& other) {
      const Triangles s = triangles_of(one.value()), t = triangles_of(other.value());
      return s.points_mm == t.points_mm && s.faces == t.faces;
    };
    EXPECT_TRUE(same(ab.united, ba.united)) << "pair " << pair;
    EXPECT_TRUE(same(ab.intersection, ba.intersection)) << "pair " << pair;
    EXPECT_TRUE(same(ab.a_minus_b, ba.b_minus_a)) << "pair " << pair;
    EXPECT_EQ(ab.residual, ba.residual) << "pair " << pair;
  }
}

struct TouchingCase {
  const char* name;
  Triangles a, b;
  double common_mm3;
};

std::vector<TouchingCase> touching_cases() {
  const Triangles cube = shapes::box({0, 0, 0}, {2, 2, 2});
  return {{"coplanar sides", cube, shapes::box({1, 0, 0}, {3, 2, 2}), 4},
          {"shared face", cube, shapes::box({2, 0, 0}, {4, 2, 2}), 0},
          {"part of a face", cube, shapes::box({2, 0.5, 0.5}, {4, 1.5, 1.5}), 0},
          {"shared edge", cube, shapes::box({2, 2, 0}, {4, 4, 2}), 0},
          {"touching vertex", cube, shapes::box({2, 2, 2}, {3, 3, 3}), 0},
          {"nested", cube, shapes::box({0.5, 0.5, 0.5}, {1, 1, 1}), 0.125},
          {"nested on a face", cube, shapes::box({0.5, 0.5, 0}, {1, 1, 1}), 0.25},
          {"identical", cube, cube, 8},
          {"a millionth apart", cube, shapes::box({2 + 1e-6, 0, 0}, {4, 2, 2}), 0},
          {"a millionth deep", cube, shapes::box({2 - 1e-6, 0, 0}, {4, 2, 2}), 4e-6}};
}

/// The 24 turns that lay axes on axes, then ten at random.
std::vector<glm::dmat4> poses() {
  std::vector<glm::dmat4> poses;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int signs = 0; signs < 4 && x != y; ++signs) {
        glm::dmat3 turn(0.0);
        turn[0][x] = signs & 1 ? -1.0 : 1.0;
        turn[1][y] = signs & 2 ? -1.0 : 1.0;
        turn[2] = glm::cross(turn[0], turn[1]);
        poses.emplace_back(turn);
      }
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    poses.push_back(any_motion(random, 20.0));
  }
  return poses;
}

TEST(BooleanPairs, TouchingSolidsComeOutRightInEveryPose) {
  ASSERT_EQ(poses().size(), 34u);
  int told_of_touching = 0;
  for (const TouchingCase& touching : touching_cases()) {
    int pose = 0;
    for (const glm::dmat4& motion : poses()) {
      const std::string what = std::string(touching.name) + ", pose " + std::to_string(pose++);
      const Solid a = moved(solid_of(touching.a), motion), b = moved(solid_of(touching.b), motion);
      const Booleans results = booleans(a, b);
      bool was_shifted = false;
      for (const std::string& finding : results.findings) {
        was_shifted |= finding.rfind("shifted", 0) == 0;
        told_of_touching += finding.find("touches itself") != std::string::npos;
      }
      // The tolerance for rounded coordinates, or three steps of the remedy over the area of either operand.
      const double tolerance = was_shifted ? 3 * 0x1p-18 * std::sqrt(48.0) * 24 : 1e-11;
      const double of_a = volume_mm3(a), of_b = volume_mm3(b);
      EXPECT_NEAR(volume_mm3(results.intersection.value()), touching.common_mm3, tolerance) << what;
      EXPECT_NEAR(volume_mm3(results.united.value()), of_a + of_b - touching.common_mm3, tolerance) << what;
      EXPECT_NEAR(volume_mm3(results.a_minus_b.value()), of_a - touching.common_mm3, tolerance) << what;
      EXPECT_NEAR(volume_mm3(results.b_minus_a.value()), of_b - touching.common_mm3, tolerance) << what;
      expect_closed(*results.united, what + ", union");
      expect_closed(*results.a_minus_b, what + ", a - b");
      EXPECT_LE(results.residual.value_or(1.0), 1e-9) << what;
    }
  }
  EXPECT_GT(told_of_touching, 24);  // shared edges at least
}

TEST(BooleanPairs, FacesThatCoincideButForRoundingLeaveNoFilmInAnyPose) {
  // A box on a side of another one, whose face is then divided little; and two such boxes.
  const Triangles cube = shapes::box({0, 0, 0}, {2, 2, 2}), one = shapes::box({2, 0.25, 0.25}, {4, 0.5, 0.5}),
                  two = shapes::together(one, shapes::box({2, 1.25, 1.25}, {4, 1.75, 1.75}));
  for (int i = 0; i < 68; ++i) {
    // The operands are only turned: the rounding of a shift may exceed the last digits of the shifted
    // coordinates.
    const glm::dmat4 motion(glm::dmat3(poses().at(static_cast<std::size_t>(i / 2))));
    const Booleans results =
        booleans(moved(solid_of(cube), motion), moved(solid_of(i % 2 ? two : one), motion));
    for (const std::string& finding : results.findings)
      EXPECT_EQ(finding.find("film"), std::string::npos) << i << ": " << finding;
    EXPECT_EQ(results.intersection.value().mesh().n_faces(), 0u) << i;
    // The parts of `two` are apart. None may be taken for inside because it almost touches.
    EXPECT_NEAR(volume_mm3(results.united.value()), i % 2 ? 8.625 : 8.125, 1e-12);
  }
}

TEST(BooleanPairs, SurfacesARoundingApartEndAndAddUp) {
  // The same ball after single precision: triangles cross their twins all over.
  const Triangles exact = shapes::sphere({1, 2, 3}, 12, 3);
  Triangles rounded = exact;
  for (glm::dvec3& p : rounded.points_mm) p = glm::dvec3(glm::vec3(p));
  const BooleanResult common = boolean(solid_of(exact), Operation::Intersection, solid_of(rounded));
  const double whole = size_of(exact).volume_mm3;
  EXPECT_NEAR(volume_mm3(common.solid), whole, 4 * 0x1p-18 * 42.0 * size_of(exact).area_mm2);
  // Too few of the results may be manifold for a residual; then a finding reports it.
  if (common.residual) {
    EXPECT_LE(*common.residual, 1e-9);
  } else {
    EXPECT_FALSE(common.findings.empty());
  }
}

struct ReferenceSolid {
  std::string name;
  Triangles triangles;
};

/// The healthy reference meshes. For every other one, checks that a refusal names a triangle.
std::vector<ReferenceSolid> reference_solids() {
  std::vector<ReferenceSolid> solids;
  int refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(tests::reference_data("meshes"))) {
    const Triangles triangles = read_triangles(entry.path());
    const Health found = health(triangles);
    if (found.solid()) {
      solids.push_back({entry.path().filename().string(), triangles});
      continue;
    }
    ++refused;
    for (const std::string& finding : found.findings)
      EXPECT_NE(finding.find("(first: triangle"), std::string::npos) << entry.path() << ": " << finding;
  }
  EXPECT_EQ(refused, 5);
  EXPECT_EQ(solids.size(), 5u);
  std::sort(solids.begin(), solids.end(),
            [](const ReferenceSolid& a, const ReferenceSolid& b) { return a.name < b.name; });
  return solids;
}

/// The triangles moved to the origin and scaled to one size, so that all overlap.
Triangles centred(Triangles triangles) {
  const Size size = size_of(triangles);
  const double extent = glm::length(size.high_mm - size.low_mm);
  for (glm::dvec3& p : triangles.points_mm) p = 100.0 / extent * (p - 0.5 * (size.high_mm + size.low_mm));
  return triangles;
}

TEST(BooleanPairs, EveryPairOfReferenceMeshesGivesSolidsOrIsRefusedByWhatIsWrong) {
  OCTOTOMY_NEEDS_DATA("meshes/ballA.off");
  const std::vector<ReferenceSolid> solids = reference_solids();
  int cutting = 0;
  for (const auto& [name_a, a] : solids)
    for (const auto& [name_b, b] : solids)
      for (const bool as_they_stand : {true, false}) {
        const std::string what = name_a + " and " + name_b + (as_they_stand ? " as they stand" : " centred");
        const Booleans results =
            as_they_stand ? booleans(trusted_solid(a, Proof::Connection), trusted_solid(b, Proof::Connection))
                          : booleans(trusted_solid(centred(a), Proof::Connection),
                                     trusted_solid(centred(b), Proof::Connection));
        EXPECT_LE(results.residual.value_or(1.0), 1e-9) << what;
        expect_closed(results.united.value(), what + ", union");
        expect_closed(results.intersection.value(), what + ", intersection");
        expect_closed(results.a_minus_b.value(), what + ", a - b");
        expect_closed(results.b_minus_a.value(), what + ", b - a");
        cutting += results.intersection->mesh().n_faces() > 0 && results.a_minus_b->mesh().n_faces() > 0;
      }
  EXPECT_GE(cutting, 20);
}

}  // namespace
}  // namespace octotomy::brep
