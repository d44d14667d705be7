// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/digitise.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <tbb/global_control.h>

#include "tests/unit_universe.h"
#include "tests/voxel/dense.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/operand.h"
#include "voxel/solid/target_expression.h"

namespace octotomy::voxel {
namespace {

using tests::universe_about_origin;

constexpr double pi = std::numbers::pi;

glm::dmat3 some_turn() {
  return glm::dmat3(moved_from_still({.degrees = 37, .axis = {1, 2, -0.5}}));
}

// An oblique lattice of voxels that are not cubes.
Universe oblique_universe(int depth) {
  Universe universe{depth, glm::dmat4(some_turn() * glm::dmat3(0.9, 0, 0, 0, 1.1, 0, 0, 0, 1.7))};
  universe.lps_from_voxel[3] =
      glm::dvec4(-glm::dvec3(universe.lps_from_voxel * glm::dvec4(glm::dvec3(0.5 * (1 << depth)), 0)), 1);
  return universe;
}

Region ring_of_squares() {
  const auto square = [](double half) {
    return std::vector<glm::dvec2>{{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  };
  Region region{parse_view("25,40"), {square(6.3), square(2.2)}};
  region.polygons_mm.push_back({{7.5, 0}, {9.5, 0.3}, {8, 3}});
  return region;
}

struct Named {
  std::string name;
  Expression solid;
};

std::vector<Named> solids() {
  const glm::dmat3 turn = some_turn();
  const glm::dvec3 look = ring_of_squares().view.look;
  return {
      {"sphere", Sphere{{0.3, -0.7, 0.2}, 7.3}},
      {"sphere on the lattice", Sphere{{0, 0, 0}, 8}},
      {"ellipsoid", Ellipsoid{{0.3, -0.7, 0.2}, {9, 4, 2.5}, turn}},
      {"box on the lattice", Box{{-4, -8, 2}, {6, -3, 8}}},
      {"box between voxels", Box{{-4.3, -8.1, 2.6}, {6.4, -3.2, 8.1}}},
      {"oriented box", OrientedBox{{0.3, -0.7, 0.2}, {8, 5, 1.5}, turn}},
      {"half-space", HalfSpace{glm::normalize(glm::dvec3(1, -2, 0.4)), 1.3}},
      {"half-space on the lattice", HalfSpace{{0, 0, 1}, 2}},
      {"cylinder", Cylinder{{-6, -5, -3}, {5, 6, 4}, 3.3}},
      {"upright cylinder", Cylinder{{1, 0, -6}, {1, 0, 4.5}, 5}},
      {"torus", Torus{{0.2, 0.1, -0.4}, glm::normalize(glm::dvec3(1, 2, 3)), 6.5, 2.4}},
      {"upright torus", Torus{{0.2, 0.1, -0.4}, {0, 1, 0}, 6.5, 2.4}},
      {"prism", Expression(RegionMask{{ring_of_squares()}}) & HalfSpace{look, 6.1} & HalfSpace{-look, 4.2}},
      {"lens", Expression(Sphere{{-4, 0, 0}, 8}) & Sphere{{5, 1, 0}, 7}},
      {"shell", Expression(Sphere{{0, 0, 0}, 9}) - Sphere{{0.5, 0, 0}, 7}},
      {"ball less a wedge", Expression(Sphere{{0, 0, 0}, 9}) & HalfSpace{{0, 0, 1}, 1.2} &
                                ~Expression(OrientedBox{{4, 0, 0}, {5, 2, 12}, turn})}};
}

TEST(Digitise, TheThesissSphereHasTheNodesOfTable3_1) {
  const PartialOctree sphere = digitise_partial(universe_about_origin(8), Sphere{{0, 0, 0}, 64});
  const std::vector<LevelCount> expected{{1, 8, 0, 0},           {2, 8, 0, 56},        {3, 56, 8, 0},
                                         {4, 272, 72, 104},      {5, 1160, 480, 536},  {6, 4760, 2240, 2280},
                                         {7, 19232, 9360, 9488}, {8, 0, 115784, 38072}};
  const std::vector<LevelCount> counted = level_counts(sphere);
  ASSERT_EQ(counted.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(counted[i].level, expected[i].level);
    EXPECT_EQ(counted[i].partial, expected[i].partial) << "level " << expected[i].level;
    EXPECT_EQ(counted[i].full, expected[i].full) << "level " << expected[i].level;
    EXPECT_EQ(counted[i].empty, expected[i].empty) << "level " << expected[i].level;
  }
  // A sphere that is off the middle by half a voxel has other nodes: the table is not met by accident.
  const PartialOctree shifted = digitise_partial(universe_about_origin(8), Sphere{{0.5, 0, 0}, 64});
  EXPECT_NE(level_counts(shifted)[6].partial, 19232U);
}

TEST(Digitise, InsideAndTouchingSwapUnderComplementToTheVoxel) {
  for (const Universe& universe :
       {universe_about_origin(5), oblique_universe(4), universe_about_origin(3), universe_about_origin(2)})
    for (const Named& named : solids()) {
      SCOPED_TRACE(named.name + " in " + std::to_string(universe.side()));
      const Octree inside = digitise(universe, named.solid, Digitisation::Inside);
      const Octree touching = digitise(universe, named.solid, Digitisation::Touching);
      const Octree touching_rest = digitise(universe, ~named.solid, Digitisation::Touching);
      const Octree inside_rest = digitise(universe, ~named.solid, Digitisation::Inside);
      EXPECT_TRUE(combine(universe, ~Expression(touching_rest)) == inside);
      EXPECT_TRUE(combine(universe, ~Expression(inside_rest)) == touching);
      const PartialOctree partial = digitise_partial(universe, named.solid);
      EXPECT_NO_THROW(check(partial));
      EXPECT_TRUE(partial.inside == inside);
      EXPECT_TRUE(partial.touching == touching);
    }
}

// Points of a voxel on a grid that reaches into its corners.
template <typename Visit>
void for_each_point(const glm::ivec3& voxel, int fineness, const Visit& visit) {
  for (int i = 0; i < fineness * fineness * fineness; ++i) {
    const glm::ivec3 step(i % fineness, (i / fineness) % fineness, i / (fineness * fineness));
    visit(glm::dvec3(voxel) - 0.5 + (glm::dvec3(step) + 0.5) / static_cast<double>(fineness));
  }
}

TEST(Digitise, AgreesWithPointsSampledInEveryVoxel) {
  constexpr int fineness = 12;
  for (const Universe& universe : {universe_about_origin(5), oblique_universe(4)})
    for (const Named& named : solids()) {
      SCOPED_TRACE(named.name + " in " + std::to_string(universe.side()));
      const TargetExpression cut(postfix_of(named.solid), universe);
      const tests::Dense inside = tests::dense_of(digitise(universe, named.solid, Digitisation::Inside));
      const tests::Dense touching = tests::dense_of(digitise(universe, named.solid, Digitisation::Touching));
      const tests::Dense centre = tests::dense_of(digitise(universe, named.solid, Digitisation::Centre));
      int wrong = 0;
      int boundary = 0;
      int without_witness = 0;
      inside.for_each([&](const glm::ivec3& v) {
        wrong += centre.at(v) != cut.contains(glm::dvec3(v));
        const bool mixed = touching.at(v) != 0 && inside.at(v) == 0;
        // Away from the boundary a few points speak for all.
        int in = 0;
        const int fine = mixed ? fineness : 2;
        for_each_point(v, fine, [&](const glm::dvec3& p) { in += cut.contains(p); });
        int all = fine * fine * fine;
        if (inside.at(v) != 0) wrong += in != all;
        if (touching.at(v) == 0) wrong += in != 0;
        boundary += mixed;
        if (!mixed) return;
        // Thin corners and edges of a voxel need points close to its faces.
        for (const int finer : {fineness, 6 * fineness}) {
          if (in != 0 && in != all) break;
          // Planes of simple slopes graze many corners by the same small overlap: the second look goes
          // closer.
          const double inset = finer == fineness ? 0.998 : 1.0 - 1e-6;
          for_each_point(v, finer, [&](const glm::dvec3& p) {
            in += cut.contains(glm::dvec3(v) + (p - glm::dvec3(v)) * (inset / (1.0 - 1.0 / finer)));
            ++all;
          });
        }
        without_witness += in == 0 || in == all;
      });
      EXPECT_EQ(wrong, 0);
      EXPECT_GT(boundary + (named.name.ends_with("lattice") ? 1 : 0), 0);
      // What is thinner than the inset goes unseen: no more than one in a hundred.
      EXPECT_LE(without_witness, 2 + boundary / 100) << boundary << " boundary voxels";
    }
}

TEST(Digitise, FractionsAreThoseOfPointsSampledInTheVoxel) {
  constexpr int fineness = 24;
  for (const Universe& universe : {universe_about_origin(5), oblique_universe(4)})
    for (const Named& named : solids()) {
      SCOPED_TRACE(named.name + " in " + std::to_string(universe.side()));
      const TargetExpression cut(postfix_of(named.solid), universe);
      const PartialOctree partial = digitise_partial(universe, named.solid);
      const Octree half = digitise(universe, named.solid, Digitisation::Half);
      double worst = 0.0;
      int visited = 0;
      for_each_boundary_voxel(partial, [&](const glm::ivec3& v, std::uint16_t fraction) {
        EXPECT_EQ(half.contains(v), fraction >= 32768) << v.x << ' ' << v.y << ' ' << v.z;
        if (visited++ % 7 != 0) return;
        int in = 0;
        for_each_point(v, fineness, [&](const glm::dvec3& p) { in += cut.contains(p); });
        const double sampled = in / std::pow(fineness, 3);
        worst = std::max(worst, std::abs(sampled - fraction / 65535.0));
      });
      // A surface along the grid of points shifts a whole layer of them: half a step, and what the fraction
      // itself may err.
      EXPECT_LE(worst, 0.5 / fineness + 0x1p-6);
    }
}

TEST(Digitise, VolumesByFractionsHoldFromRadiusThree) {
  for (const double radius : {3.0, 3.7, 5.0, 8.0, 12.0}) {
    SCOPED_TRACE("radius " + std::to_string(radius));
    const Universe universe = universe_about_origin(5);
    const double ball = 4.0 / 3.0 * pi * radius * radius * radius;
    EXPECT_NEAR(volume_mm3(digitise_partial(universe, Sphere{{0.2, 0.1, -0.3}, radius})) / ball, 1.0, 2e-3);
    const glm::dvec3 radii(radius, 0.8 * radius, 0.9 * radius);
    const double ellipsoid = ball * 0.8 * 0.9;
    EXPECT_NEAR(
        volume_mm3(digitise_partial(universe, Ellipsoid{{0.2, 0.1, -0.3}, radii, some_turn()})) / ellipsoid,
        1.0, 2e-3);
    const double cylinder = pi * radius * radius * 2.0 * radius;
    const glm::dvec3 along = some_turn()[0] * radius;
    EXPECT_NEAR(volume_mm3(digitise_partial(universe, Cylinder{-along, along, radius})) / cylinder, 1.0,
                2e-3);
    const OrientedBox box{{0.2, 0.1, -0.3}, 0.7 * glm::dvec3(radius, radius, radius), some_turn()};
    EXPECT_NEAR(volume_mm3(digitise_partial(universe, box)) / std::pow(1.4 * radius, 3), 1.0, 2e-3);
  }
  const Torus torus{{0.2, 0, 0.4}, glm::normalize(glm::dvec3(1, 2, 3)), 8, 3};
  EXPECT_NEAR(volume_mm3(digitise_partial(universe_about_origin(5), torus)) / (2 * pi * pi * 8 * 9), 1.0,
              2e-3);
}

TEST(Digitise, ABoxOfWholeVoxelsIsThoseVoxelsByEveryDigitisation) {
  const Universe universe = universe_about_origin(4);
  const Box box{{-3, -8, 0}, {5, -2, 8}};
  const Octree expected = combine(universe, box);
  EXPECT_EQ(expected.voxel_count(), 8U * 6 * 8);
  for (const Digitisation digitisation :
       {Digitisation::Inside, Digitisation::Touching, Digitisation::Centre, Digitisation::Half})
    EXPECT_TRUE(digitise(universe, box, digitisation) == expected);
  const PartialOctree partial = digitise_partial(universe, box);
  EXPECT_TRUE(partial.fractions.empty());
  // Moved by a quarter of a voxel along x, two layers of voxels are cut, and to the share they say.
  const PartialOctree moved = digitise_partial(universe, Box{{-2.75, -8, 0}, {5.25, -2, 8}});
  EXPECT_EQ(moved.inside.voxel_count(), 7U * 6 * 8);
  EXPECT_EQ(moved.touching.voxel_count(), 9U * 6 * 8);
  for_each_boundary_voxel(moved, [](const glm::ivec3& v, std::uint16_t fraction) {
    EXPECT_NEAR(fraction / 65535.0, v.x == 5 ? 0.75 : 0.25, 1e-5);
  });
}

TEST(Digitise, AnOctreeStandsForItsWholeVoxels) {
  const Universe universe = universe_about_origin(5);
  const Sphere sphere{{1, 2, 3}, 9.3};
  const Octree board =
      combine(universe, Expression(Box{{-20, -20, -20}, {2, 3, 4}}) ^ Box{{-5, -6, -7}, {20, 20, 20}});
  const PartialOctree whole = digitise_partial(universe, sphere);
  const PartialOctree part = digitise_partial(universe, Expression(sphere) & board);
  EXPECT_TRUE(part.inside == combine(universe, Expression(whole.inside) & board));
  EXPECT_TRUE(part.touching == combine(universe, Expression(whole.touching) & board));
  std::vector<std::uint16_t> kept;
  for_each_boundary_voxel(whole, [&](const glm::ivec3& v, std::uint16_t fraction) {
    if (board.contains(v)) kept.push_back(fraction);
  });
  ASSERT_FALSE(kept.empty());
  EXPECT_EQ(part.fractions, kept);
}

TEST(Digitise, UnionsAndDifferencesAddUpToTheirParts) {
  const Universe universe = universe_about_origin(5);
  const Expression a = Sphere{{-3.1, 0.2, 0.3}, 8.3}, b = Torus{{2.7, 1.4, -0.6}, {0, 0, 1}, 6.2, 2.4};
  const auto mm3 = [&](const Expression& solid) { return volume_mm3(digitise_partial(universe, solid)); };
  EXPECT_NEAR(mm3(a | b), mm3(a) + mm3(b) - mm3(a & b), 1.0);
  EXPECT_NEAR(mm3(a ^ b), mm3(a - b) + mm3(b - a), 1.0);
  EXPECT_GT(mm3(a & b), 100.0);
}

TEST(Digitise, AMovedSolidIsTheSolidMadeInItsPlace) {
  const Universe universe = universe_about_origin(5);
  const glm::dmat4 motion = moved_from_still({.translate_mm = {1.5, -2.25, 3}});
  const PartialOctree moved_there = digitise_partial(universe, moved(Sphere{{0, 0, 0}, 7.3}, motion));
  const PartialOctree made_there = digitise_partial(universe, Sphere{{1.5, -2.25, 3}, 7.3});
  EXPECT_TRUE(moved_there.touching == made_there.touching);
  EXPECT_EQ(moved_there.fractions, made_there.fractions);
}

TEST(Digitise, IsTheSameOnOneThreadAndTwo) {
  const Expression solid = solids().back().solid;
  const PartialOctree two = digitise_partial(universe_about_origin(6), solid);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const PartialOctree one = digitise_partial(universe_about_origin(6), solid);
  EXPECT_TRUE(one.inside == two.inside && one.touching == two.touching);
  EXPECT_EQ(one.fractions, two.fractions);
}

TEST(Digitise, APlanesShareOfACubeIsItsClosedForm) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    // Degenerate directions among them: along an axis, along a diagonal, a hair off both.
    glm::dvec3 gradient(number(random), number(random), number(random));
    if (i % 5 == 1) gradient.x = 0;
    if (i % 5 == 2) gradient.x = gradient.y = 0;
    if (i % 5 == 3) gradient.x = gradient.y * 1e-9;
    if (i % 5 == 4) gradient = glm::dvec3(1, 1, 1);
    const double value = number(random);
    const double share = share_below({gradient, value}, 0.5);
    EXPECT_NEAR(share + share_below({-gradient, -value}, 0.5), 1.0, 1e-12) << "case " << i;
    int in = 0;
    constexpr int fineness = 20;
    for_each_point(glm::ivec3(0), fineness,
                   [&](const glm::dvec3& p) { in += glm::dot(gradient, p) + value <= 0; });
    EXPECT_NEAR(share, in / std::pow(fineness, 3), 0.026) << "case " << i;
  }
  EXPECT_DOUBLE_EQ(share_below({{0, 0, 2}, 0.5}, 0.5), 0.25);
  EXPECT_NEAR(share_below({{1, 1, 1}, 1.0}, 0.5), 0.125 / 6, 1e-15);
}

TEST(Digitise, RefusesSolidsThatAreNone) {
  EXPECT_THROW(Expression(Sphere{{0, 0, 0}, -1}), std::invalid_argument);
  EXPECT_THROW(Expression(Sphere{{0, 0, 0}, 0}), std::invalid_argument);
  EXPECT_THROW(Expression(Sphere{{NAN, 0, 0}, 1}), std::invalid_argument);
  EXPECT_THROW(Expression(Box{{0, 0, 0}, {1, 0, 1}}), std::invalid_argument);
  EXPECT_THROW(Expression(Ellipsoid{{0, 0, 0}, {1, 0, 1}}), std::invalid_argument);
  EXPECT_THROW(Expression(OrientedBox{{0, 0, 0}, {1, 1, 1}, glm::dmat3(2)}), std::invalid_argument);
  EXPECT_THROW(Expression(Torus{{0, 0, 0}, {0, 0, 1}, 2, 2}), std::invalid_argument);
  EXPECT_THROW(Expression(Torus{{0, 0, 0}, {0, 0, 2}, 3, 2}), std::invalid_argument);
  EXPECT_THROW(Expression(Cylinder{{0, 0, 0}, {0, 0, 0}, 2}), std::invalid_argument);
  EXPECT_THROW(Expression(HalfSpace{{0, 0, 1}, INFINITY}), std::invalid_argument);
  EXPECT_THROW(Expression(RegionMask{{Region{}}}), std::invalid_argument);
}

TEST(Digitise, RefusesAWindowWhichHasNoShapeWithinAVoxel) {
  const Universe universe = universe_about_origin(4);
  Scene scene;
  scene.lattice = universe.lattice();
  scene.samples = Int16Samples(16 * 16 * 16, 100);
  const Window window{grey_octree_of(universe, scene), 50, 200};
  EXPECT_EQ(digitise(universe, window, Digitisation::Centre).voxel_count(), 4096U);
  EXPECT_THROW(digitise(universe, window, Digitisation::Inside), std::invalid_argument);
  EXPECT_THROW(digitise_partial(universe, window), std::invalid_argument);
}

TEST(PartialOctree, ChecksItsFractionsAndItsOrder) {
  const Universe universe = universe_about_origin(4);
  PartialOctree partial = digitise_partial(universe, Sphere{{0, 0, 0}, 5});
  EXPECT_NO_THROW(check(partial));
  PartialOctree short_of_one = partial;
  short_of_one.fractions.pop_back();
  EXPECT_THROW(check(short_of_one), std::invalid_argument);
  PartialOctree swapped{partial.touching, partial.inside, partial.fractions};
  EXPECT_THROW(check(swapped), std::invalid_argument);
}

// The answer comes from a corner, from a plane, or from a search of the cube's faces: all must be met.
TEST(BallOperand, MeetsACubeThatIsSkewToItWhereTheCubesPointsSay) {
  const Ellipsoid ellipsoid{{0.3, -0.7, 0.2}, {9, 4, 2.5}, some_turn()};
  const BallOperand ball(ellipsoid, glm::dmat4(1.0));
  int met = 0, dips = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) {
      return std::uniform_real_distribution(low, high)(random);
    };
    const glm::dvec3 way =
        glm::normalize(glm::dvec3(between(-1, 1), between(-1, 1), between(-1, 1)) + glm::dvec3(1e-3));
    const Cube cube{
        ellipsoid.centre_mm + ellipsoid.lps_from_axes * (ellipsoid.radii_mm * way * between(0.8, 1.5)),
        between(0.1, 2.0)};
    constexpr int parts = 8;
    double nearest = std::numeric_limits<double>::infinity(), nearest_corner = nearest, farthest = 0.0;
    for (int z = 0; z <= parts; ++z)
      for (int y = 0; y <= parts; ++y)
        for (int x = 0; x <= parts; ++x) {
          const glm::dvec3 p = cube.centre + cube.half * (glm::dvec3(x, y, z) * (2.0 / parts) - 1.0);
          const double far = glm::length(glm::transpose(ellipsoid.lps_from_axes) * (p - ellipsoid.centre_mm) /
                                         ellipsoid.radii_mm);
          nearest = std::min(nearest, far);
          farthest = std::max(farthest, far);
          if (x % parts == 0 && y % parts == 0 && z % parts == 0)
            nearest_corner = std::min(nearest_corner, far);
        }
    // The nearest point lies within half a part's diagonal of one that was asked.
    const double slack = std::sqrt(3.0) * cube.half / parts / 2.5;
    const Meets meets = ball.meets(cube);
    ASSERT_TRUE(meets.decided());
    if (nearest < 1.0 || nearest > 1.0 + slack) {
      ASSERT_EQ(meets.in, nearest < 1.0) << "seed " << seed << ": " << nearest;
    }
    ASSERT_EQ(meets.out, farthest > 1.0) << "seed " << seed << ": " << farthest;
    met += meets.in;
    dips += nearest < 1.0 && nearest_corner > 1.0;
  }
  EXPECT_GT(met, 200);
  EXPECT_LT(met, 1800);
  EXPECT_GT(dips, 20);
}

}  // namespace
}  // namespace octotomy::voxel
