// SPDX-License-Identifier: AGPL-3.0-or-later
//
// What moves: the digitisations of moved octrees, the interpolations of moved samples, and what a full circle
// of small rotations does to a volume.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/voxel/dense.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/combine_grey.h"
#include "voxel/tree/interpolate.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;

const Resampling half_voxels{Resampling::Voxels::Half, Interpolation::Linear};

glm::dmat4 turn(double degrees, const glm::dvec3& axis, const glm::dvec3& about_mm) {
  Motion motion;
  motion.degrees = degrees;
  motion.axis = axis;
  motion.about_mm = about_mm;
  return moved_from_still(motion);
}

template <typename Function>
Scene scene_of(const Universe& universe, const Function& value) {
  Scene scene;
  scene.lattice = universe.lattice();
  voxel::Int16Samples samples;
  const int side = universe.side();
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        samples.push_back(static_cast<std::int16_t>(std::lround(value(glm::dvec3(x, y, z)))));
  scene.samples = std::move(samples);
  return scene;
}

TEST(Resampling, HalfTakesTheVoxelsOfWhichHalfThePointsAreInside) {
  const Universe universe{5, glm::dmat4(1.0)};
  int differ = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Octree still = tests::octree_of(universe, tests::random_dense(32, seed + 40));
    const glm::dmat4 matrix = turn(11.0 + 23.0 * static_cast<double>(seed), {1, -0.4, 0.7}, {15, 16.3, 14});
    const glm::dmat4 back = glm::inverse(matrix);
    const Octree moved_half = combine(universe, moved(still, matrix), half_voxels);
    const Octree moved_centre = combine(universe, moved(still, matrix));
    for (int z = 0; z < 32; ++z)
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          int inside = 0;
          for (int i = 0; i < 125; ++i) {
            const glm::dvec3 point =
                glm::dvec3(x, y, z) + (glm::dvec3(i % 5, (i / 5) % 5, i / 25) + 0.5) / 5.0 - 0.5;
            const glm::dvec3 p(back * glm::dvec4(point, 1.0));
            inside += still.contains(glm::ivec3(glm::floor(p + 0.5)));
          }
          // A point on the face between two voxels, but for rounding, may be given to either: leave ties out.
          if (inside == 62 || inside == 63) continue;
          ASSERT_EQ(moved_half.contains({x, y, z}), inside > 62) << x << ' ' << y << ' ' << z;
        }
    differ += !(moved_half == moved_centre);
  }
  EXPECT_GT(differ, 3) << "D4 was never other than D3, so nothing was tested";
}

TEST(Resampling, AFlatFaceTakesTheVoxelOnceItFillsHalfOfIt) {
  const Universe universe{5, glm::dmat4(1.0)};
  const Octree slab = combine(universe, Box{{-1, -1, -1}, {9.5, 40, 40}});
  Motion third;
  third.translate_mm = {0.3, 0, 0};
  Motion most;
  most.translate_mm = {0.7, 0, 0};
  EXPECT_EQ(combine(universe, moved(slab, moved_from_still(most)), half_voxels).contains({10, 5, 5}), true);
  EXPECT_EQ(combine(universe, moved(slab, moved_from_still(third)), half_voxels).contains({10, 5, 5}), false);
}

TEST(Interpolate, ReproducesWhatItsOrderPromises) {
  const Universe universe{4, glm::dmat4(1.0)};
  const GreyOctree linear = grey_octree_of(universe, scene_of(universe, [](const glm::dvec3& p) {
                                             return 8.0 * p.x - 4.0 * p.y + 2.0 * p.z + 1.0;
                                           }));
  const GreyOctree square = grey_octree_of(
      universe, scene_of(universe, [](const glm::dvec3& p) { return 4.0 * p.x * p.x - 8.0 * p.y * p.z; }));
  const glm::dvec3 p(6.25, 7.5, 5.75);
  EXPECT_EQ(interpolate(linear, p, Interpolation::Nearest), linear.sample({6, 8, 6}));
  EXPECT_NEAR(interpolate(linear, p, Interpolation::Linear), 8 * 6.25 - 4 * 7.5 + 2 * 5.75 + 1, 1e-12);
  EXPECT_NEAR(interpolate(linear, p, Interpolation::Cubic), 8 * 6.25 - 4 * 7.5 + 2 * 5.75 + 1, 1e-12);
  const double truth = 4 * 6.25 * 6.25 - 8 * 7.5 * 5.75;
  EXPECT_NEAR(interpolate(square, p, Interpolation::Cubic), truth, 1e-12);
  EXPECT_GT(std::abs(interpolate(square, p, Interpolation::Linear) - truth), 0.5);
}

TEST(Interpolate, StaysWithinTheRangeItSays) {
  const Universe universe{3, glm::dmat4(1.0)};
  int beyond = 0;
  for (int seed = 0; seed < 200; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const GreyOctree grey = grey_octree_of(
        universe, scene_of(universe, [&](const glm::dvec3&) { return random() & 1 ? 700 : -100; }));
    const std::array<double, 3> t{random() % 1000 * 1e-3, random() % 1000 * 1e-3, random() % 1000 * 1e-3};
    const glm::dvec3 p(3.0 + t[0], 3.0 + t[1], 3.0 + t[2]);
    for (const Interpolation interpolation :
         {Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic}) {
      const double value = interpolate(grey, p, interpolation);
      const ValueRange range = value_range({-100, 700}, interpolation);
      EXPECT_GE(value, range.low);
      EXPECT_LE(value, range.high);
      beyond += value < -100 || value > 700;
    }
  }
  EXPECT_GT(beyond, 10) << "the cubic never overshot, so its wider range was not tried";
}

TEST(Resampling, MovedWindowsFollowTheirInterpolation) {
  const Universe universe{5, glm::dmat4(1.0)};
  const GreyOctree grey = grey_octree_of(
      universe,
      scene_of(
          universe,
          [](const glm::dvec3& p) { return 900.0 * std::sin(0.6 * p.x + 0.2 * p.z) * std::cos(0.5 * p.y); }),
      -2000);
  const glm::dmat4 matrix = turn(23, {0.3, 1, -0.6}, {15, 15, 15});
  const glm::dmat4 back = glm::inverse(matrix);
  Octree before = Octree::empty(universe);
  for (const Interpolation interpolation :
       {Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic}) {
    const Octree octree =
        combine(universe, moved(Window{grey, 250, 700}, matrix), {Resampling::Voxels::Centre, interpolation});
    for (int z = 0; z < 32; ++z)
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          const glm::dvec3 p(back * glm::dvec4(x, y, z, 1.0));
          const double value = interpolation == Interpolation::Linear ? interpolate_scan(grey, p)
                                                                      : interpolate(grey, p, interpolation);
          if (std::abs(value - 250) < 1e-9 || std::abs(value - 700) < 1e-9) continue;
          ASSERT_EQ(octree.contains({x, y, z}), value >= 250 && value <= 700) << x << ' ' << y << ' ' << z;
        }
    EXPECT_GT(octree.voxel_count(), 3000U);
    EXPECT_FALSE(octree == before) << "two interpolations gave the same voxels";
    before = octree;
  }
}

// A scan of one value that ends within the universe: half way to the background there are neither a film of
// values between both nor a layer less.
TEST(Resampling, NoWindowIsMixedWithWhatLiesBeyondItsScan) {
  const Universe universe{5, glm::dmat4(1.0)};
  Scene scene;
  scene.lattice = universe.lattice();
  scene.lattice.dims = {12, 10, 14};
  scene.lattice.lps_from_voxel[3] = glm::dvec4(9, 10, 8, 1.0);
  scene.samples = Int16Samples(scene.lattice.sample_count(), 900);
  const GreyOctree grey = grey_octree_of(universe, scene, -2000);
  const glm::dmat4 matrix = turn(23, glm::normalize(glm::dvec3(0.3, 1, -0.6)), {15, 15, 15});
  const Octree film = combine(universe, moved(Window{grey, -1500, 800}, matrix)),
               whole = combine(universe, moved(Window{grey, 800, 1000}, matrix)),
               box = combine(universe, moved(Expression(Box{{8.5, 9.5, 7.5}, {20.5, 19.5, 21.5}}), matrix));
  EXPECT_TRUE(film.is_empty()) << film.voxel_count();
  EXPECT_TRUE(whole == box) << whole.voxel_count() << " of " << box.voxel_count();
  EXPECT_NEAR(static_cast<double>(whole.voxel_count()), 12.0 * 10.0 * 14.0, 60.0);
}

// 36 turns of 10 degrees, evaluated every time.
template <typename Step>
void circle(const Step& step) {
  const glm::dmat4 ten = turn(10, glm::normalize(glm::dvec3(0.3, -0.5, 0.8)), {31.5, 31.5, 31.5});
  for (int i = 0; i < 36; ++i) step(ten);
}

TEST(Resampling, WindowsMovedByWholeVoxelsAreTheirVoxelsMoved) {
  const Universe universe{6, glm::dmat4(glm::dmat3(0.7))};
  std::uint32_t state = 5;
  const auto noise = [&](const glm::dvec3&) {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(static_cast<int>(state >> 28));
  };
  const GreyOctree grey = grey_octree_of(universe, scene_of(universe, noise), 3);
  std::uint64_t voxels = 0;
  // Bounds that samples have, bounds between samples, none between them, and the background's value.
  for (const auto& [low, high] : {std::pair(5.0, 9.0), {4.5, 20.0}, {4.2, 4.7}, {2.0, 6.0}})
    for (const glm::ivec3& by : {glm::ivec3(3, -11, 6), {0, 16, -32}, {-1, 0, 0}, {70, 0, 0}})
      for (const Interpolation between :
           {Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic}) {
        Motion motion;
        motion.translate_mm = 0.7 * glm::dvec3(by);
        const Expression window = Window{grey, low, high};
        const Resampling resampling{Resampling::Voxels::Centre, between};
        const Octree still = combine(universe, window);
        const Octree direct = combine(universe, moved(window, moved_from_still(motion)), resampling);
        EXPECT_EQ(direct, combine(universe, moved(still, moved_from_still(motion))))
            << low << ".." << high << " by " << by.x << ' ' << by.y << ' ' << by.z;
        voxels += direct.voxel_count();
      }
  EXPECT_GT(voxels, 100000U);
}

TEST(Resampling, AFullCircleOfSmallRotationsLosesNothingWhileItIsSymbolic) {
  const Universe universe{6, glm::dmat4(1.0)};
  const Octree ball =
      combine(universe, Expression(Sphere{{30, 33, 31}, 20}) - Box{{31, 31, 31}, {60, 60, 60}});
  Expression symbolic = ball;
  circle([&](const glm::dmat4& ten) { symbolic = moved(symbolic, ten); });
  const Octree composed = combine(universe, symbolic);
  // The product of 36 matrices is the identity but for rounding, so no centre leaves its voxel.
  EXPECT_TRUE(composed == ball);

  // Evaluated at every step it drifts: that is what composing is for. By how much octotomy-bench tells.
  for (const Resampling& resampling : {Resampling{}, half_voxels}) {
    Octree stepped = ball;
    circle([&](const glm::dmat4& ten) { stepped = combine(universe, moved(stepped, ten), resampling); });
    const auto changed = combine(universe, Expression(stepped) ^ ball).voxel_count();
    EXPECT_GT(changed, 100U) << "36 samplings left the object as it was: were they done?";
  }
}

TEST(CombineGrey, KeepsTheSamplesOfTheFirstWindowThatHoldsTheVoxel) {
  const Universe universe{5, glm::dmat4(1.0)};
  const GreyOctree a =
      grey_octree_of(universe, scene_of(universe, [](const glm::dvec3& p) { return 10 * p.x + p.y; }), -1024);
  const GreyOctree b = grey_octree_of(
      universe, scene_of(universe, [](const glm::dvec3& p) { return 500 + 3 * p.z + p.y; }), -1024);
  const Box box{{4, 4, 4}, {20, 21, 22}};
  const Expression expression = (Expression(Window{a, 100, 250}) | Window{b, 540, 700}) & box;
  const GreyOctree result = combine_grey(universe, expression);
  const Octree voxels = combine(universe, expression);
  std::uint64_t from_a = 0;
  std::uint64_t from_b = 0;
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        const glm::ivec3 v(x, y, z);
        const bool in_a = a.sample(v) >= 100 && a.sample(v) <= 250;
        const int expected = !voxels.contains(v) ? -1024 : in_a ? a.sample(v) : b.sample(v);
        ASSERT_EQ(result.sample(v), expected) << x << ' ' << y << ' ' << z;
        if (voxels.contains(v)) ++(in_a ? from_a : from_b);
      }
  EXPECT_GT(from_a, 1000U);
  EXPECT_GT(from_b, 1000U);
  // Ranges are those of the result: a window of it is the object again.
  EXPECT_TRUE(combine(universe, Window{result, 0, 3000}) == voxels);
}

TEST(CombineGrey, FillsWhatHasNoSamplesAndKeepsAComplementsOwn) {
  const Universe universe{4, glm::dmat4(1.0)};
  const GreyOctree a =
      grey_octree_of(universe, scene_of(universe, [](const glm::dvec3& p) { return 10 * p.x; }), -1024);
  const Octree implant = combine(universe, Sphere{{3, 8, 8}, 3});
  GreyResult options;
  options.filled = 2500;
  const GreyOctree with_implant = combine_grey(universe, Expression(Window{a, 100, 3000}) | implant, options);
  EXPECT_EQ(with_implant.sample({12, 8, 8}), 120);
  EXPECT_EQ(with_implant.sample({3, 8, 8}), 2500);
  EXPECT_EQ(with_implant.sample({9, 8, 8}), -1024);
  const GreyOctree rest = combine_grey(universe, ~Expression(Window{a, 100, 3000}), options);
  EXPECT_EQ(rest.sample({9, 8, 8}), 90);
  EXPECT_EQ(rest.sample({10, 8, 8}), -1024);
  // To the right of a minus a window takes away; what is left has the samples of the left.
  const GreyOctree less = combine_grey(universe, Expression(Window{a, 0, 3000}) - Window{a, 50, 80}, options);
  EXPECT_EQ(less.sample({4, 1, 1}), 40);
  EXPECT_EQ(less.sample({5, 1, 1}), -1024);
}

TEST(CombineGrey, FindsTheBlocksOfAUniverseOfSeveralLevels) {
  const Universe universe{7, glm::dmat4(1.0)};  // the root's children are blocks of two levels
  const GreyOctree a = grey_octree_of(
      universe, scene_of(universe, [](const glm::dvec3& p) { return p.x + 3 * p.y + 7 * p.z; }), -1024);
  const Expression expression = Expression(Window{a, 0, 3000}) & Sphere{{63, 70, 58}, 31};
  const GreyOctree result = combine_grey(universe, expression);
  const Octree voxels = combine(universe, expression);
  for (int z = 0; z < 128; z += 3)
    for (int y = 0; y < 128; y += 3)
      for (int x = 0; x < 128; x += 3) {
        const glm::ivec3 v(x, y, z);
        ASSERT_EQ(result.sample(v), voxels.contains(v) ? a.sample(v) : -1024) << x << ' ' << y << ' ' << z;
      }
  EXPECT_TRUE(combine(universe, Window{result, 0, 3000}) == voxels);
}

TEST(CombineGrey, AMovedWindowIsInterpolatedAndWholeVoxelsAreExact) {
  const Universe universe{5, glm::dmat4(1.0)};
  const GreyOctree a = grey_octree_of(
      universe, scene_of(universe, [](const glm::dvec3& p) { return 20 * p.x + 11 * p.y - 7 * p.z; }), -1024);
  Motion shift;
  shift.translate_mm = {3, -2, 1};
  const GreyOctree shifted = combine_grey(universe, moved(Window{a, 0, 3000}, moved_from_still(shift)));
  for (int i = 0; i < 500; ++i) {
    const glm::ivec3 v((i * 7) % 32, (i * 13) % 32, (i * 5) % 32);
    const std::int16_t sample = a.sample(v - glm::ivec3(3, -2, 1));
    ASSERT_EQ(shifted.sample(v), sample >= 0 ? sample : -1024);
  }
  const glm::dmat4 matrix = turn(30, {0, 0, 1}, {15, 15, 15});
  const GreyOctree turned = combine_grey(universe, moved(Window{a, 0, 3000}, matrix));
  const glm::dvec3 p(glm::inverse(matrix) * glm::dvec4(17, 16, 5, 1));
  EXPECT_EQ(turned.sample({17, 16, 5}), std::floor(20 * p.x + 11 * p.y - 7 * p.z + 0.5));
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return combine_grey(universe, moved(Window{a, 0, 3000}, matrix));
  };
  const GreyOctree one = on(1);
  const GreyOctree two = on(2);
  for (int z = 0; z < 32; ++z)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) ASSERT_EQ(one.sample({x, y, z}), two.sample({x, y, z}));
}

}  // namespace
}  // namespace octotomy::voxel
