// SPDX-License-Identifier: AGPL-3.0-or-later
// Booleans of pairs made at random and of pairs that only touch, in many poses.
#include <cstdlib>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <random>

#include "brep/boolean.h"
#include "brep/health.h"
#include "brep/measure.h"
#include "brep/move.h"
#include "tests/brep/shapes.h"

namespace octotomy::brep {
namespace {

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Triangles torus(double ring, double tube, int around, int across) {
  Triangles t;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = ring + tube * std::cos(v);
      t.points_mm.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i % around * across + j % across); };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      t.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      t.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return t;
}

glm::dmat4 any_motion(Random& random, double reach) {
  const glm::dvec3 axis(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, 0.1, 1));
  const glm::dvec3 shift(uniform(random, -reach, reach), uniform(random, -reach, reach),
                         uniform(random, -reach, reach));
  return glm::rotate(glm::translate(glm::dmat4(1.0), shift), uniform(random, 0, 6.28), glm::normalize(axis));
}

/// A ball, box, turned box, torus or bumpy blob.
Mesh any_solid(Random& random) {
  const int kind = static_cast<int>(random() % 5), splits = 2 + static_cast<int>(random() % 2);
  Triangles t;
  if (kind == 0) t = shapes::sphere({0, 0, 0}, uniform(random, 3, 6), splits);
  if (kind == 1 || kind == 2)
    t = shapes::box({-uniform(random, 1, 5), -4, -3}, {4, uniform(random, 1, 5), uniform(random, 1, 5)});
  if (kind == 3) t = torus(uniform(random, 3, 5), uniform(random, 0.5, 2), 40, 20);
  if (kind == 4) {
    t = shapes::sphere({0, 0, 0}, 1, splits);
    const double a = uniform(random, 0, 3), b = uniform(random, 2, 5);
    for (glm::dvec3& p : t.points_mm) p *= 4.0 + std::sin(b * p.x + a) + 0.8 * std::cos(4 * p.y) * p.z;
  }
  const glm::dmat4 motion = kind == 1 ? glm::translate(glm::dmat4(1.0), glm::dvec3(uniform(random, -3, 3)))
                                      : any_motion(random, 4.0);
  return moved(mesh_of(t), motion);
}

void expect_closed(const Mesh& mesh, const std::string& what) {
  if (mesh.n_faces() == 0) return;
  const Health h = health(mesh, {.self_intersections = false});
  EXPECT_TRUE(h.closed && h.manifold && h.oriented) << what << ": " << h.findings.front();
}

/// 60 pairs, or as many as OCTOTOMY_PAIRS says; one alone with OCTOTOMY_PAIR=number.
TEST(BooleanPairs, VolumesOfRandomPairsAddUp) {
  const char *count_text = std::getenv("OCTOTOMY_PAIRS"), *one_text = std::getenv("OCTOTOMY_PAIR");
  const int count = count_text ? std::atoi(count_text) : 60;
  int cutting = 0, apart = 0;
  for (int pair = one_text ? std::atoi(one_text) : 0; pair < (one_text ? std::atoi(one_text) + 1 : count);
       ++pair) {
    Random random(static_cast<std::uint64_t>(pair));
    const Mesh a = any_solid(random), b = any_solid(random);
    const std::string what = "replay with OCTOTOMY_PAIR=" + std::to_string(pair);
    const Booleans results = booleans(a, b);
    ASSERT_TRUE(results.united && results.intersection && results.a_minus_b && results.b_minus_a) << what;
    ASSERT_TRUE(results.residual) << what;
    EXPECT_LE(*results.residual, 1e-9) << what;
    // The identities cannot see a part on the wrong side, which these inequalities do.
    const double of_a = volume_mm3(a), of_b = volume_mm3(b), common = volume_mm3(*results.intersection);
    EXPECT_GE(common, -1e-9) << what;
    EXPECT_LE(common, std::min(of_a, of_b) * (1 + 1e-9)) << what;
    EXPECT_GE(volume_mm3(*results.united), std::max(of_a, of_b) * (1 - 1e-9)) << what;
    expect_closed(*results.united, what + ", union");
    expect_closed(*results.intersection, what + ", intersection");
    expect_closed(*results.a_minus_b, what + ", a - b");
    expect_closed(*results.b_minus_a, what + ", b - a");
    ++(results.intersection->n_faces() > 0 ? cutting : apart);
  }
  if (!one_text) {
    EXPECT_GT(cutting, count / 3);
    EXPECT_GT(apart, 0);
  }
}

TEST(BooleanPairs, TheOrderOfTheOperandsDoesNotShowInTheBits) {
  for (std::uint64_t pair = 0; pair < 12; ++pair) {
    Random random(1000 + pair);
    const Mesh a = any_solid(random), b = any_solid(random);
    const Booleans ab = booleans(a, b), ba = booleans(b, a);
    const auto same = [&](const std::optional<Mesh>& one, const std::optional<Mesh>& other) {
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
  int shifted = 0;
  for (const TouchingCase& touching : touching_cases()) {
    int pose = 0;
    for (const glm::dmat4& motion : poses()) {
      const std::string what = std::string(touching.name) + ", pose " + std::to_string(pose++);
      const Mesh a = moved(mesh_of(touching.a), motion), b = moved(mesh_of(touching.b), motion);
      const Booleans results = booleans(a, b);
      bool was_shifted = false;
      for (const std::string& finding : results.findings) was_shifted |= finding.rfind("shifted", 0) == 0;
      shifted += was_shifted;
      // Rounded coordinates, or three steps of the remedy over the area of either.
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
  EXPECT_GT(shifted, 24);  // shared edges at least
}

TEST(BooleanPairs, SurfacesARoundingApartEndAndAddUp) {
  // The same ball after single precision: triangles cross their twins all over.
  const Triangles exact = shapes::sphere({1, 2, 3}, 12, 3);
  Triangles rounded = exact;
  for (glm::dvec3& p : rounded.points_mm) p = glm::dvec3(glm::vec3(p));
  const BooleanResult common = boolean(mesh_of(exact), Operation::Intersection, mesh_of(rounded));
  const double whole = size_of(exact).volume_mm3;
  EXPECT_NEAR(volume_mm3(common.mesh), whole, 4 * 0x1p-18 * 42.0 * size_of(exact).area_mm2);
  // Too few of the results may be manifold for a residual; then that is told.
  if (common.residual) {
    EXPECT_LE(*common.residual, 1e-9);
  } else {
    EXPECT_FALSE(common.findings.empty());
  }
}

}  // namespace
}  // namespace octotomy::brep
