// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/solid/combine.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

#include "tests/unit_universe.h"
#include "tests/voxel/dense.h"
#include "voxel/solid/combine_grey.h"
#include "voxel/tree/build.h"

namespace octotomy::voxel {
namespace {

using tests::Dense;
using tests::unit_universe;

template <typename Inside>
void expect_voxels(const Octree& octree, const Inside& inside) {
  const int side = octree.universe().side();
  std::uint64_t expected = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const glm::ivec3 v(x, y, z);
        const bool wanted = inside(v);
        expected += wanted;
        ASSERT_EQ(octree.contains(v), wanted) << "voxel " << x << ' ' << y << ' ' << z;
      }
  EXPECT_EQ(octree.voxel_count(), expected);
}

TEST(Combine, EveryOperatorAgreesWithAPlainArrayOnRandomTriples) {
  int mixed = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const int depth = 2 + static_cast<int>(seed % 4);
    SCOPED_TRACE("depth " + std::to_string(depth) + ", seed " + std::to_string(seed));
    const Universe universe = unit_universe(depth);
    const Dense a = tests::random_dense(1 << depth, 3 * seed);
    const Dense b = tests::random_dense(1 << depth, 3 * seed + 1);
    const Dense c = tests::random_dense(1 << depth, 3 * seed + 2);
    const Expression ea = tests::octree_of(universe, a);
    const Expression eb = tests::octree_of(universe, b);
    const Expression ec = tests::octree_of(universe, c);
    const auto check = [&](const Expression& expression, const auto& rule) {
      const Octree result = combine(universe, expression);
      Dense expected(1 << depth);
      for (std::size_t i = 0; i < expected.voxels.size(); ++i)
        expected.voxels[i] = rule(a.voxels[i] != 0, b.voxels[i] != 0, c.voxels[i] != 0);
      ASSERT_EQ(tests::dense_of(result).voxels, expected.voxels);
      // Canonical: however it came about, it is the tree of its voxels.
      ASSERT_TRUE(result == tests::octree_of(universe, expected));
      mixed += result.voxel_count() != 0 && !(result == Octree::full(universe));
    };
    check(ea & eb, [](bool x, bool y, bool) { return x && y; });
    check(ea | eb, [](bool x, bool y, bool) { return x || y; });
    check(ea - eb, [](bool x, bool y, bool) { return x && !y; });
    check(ea ^ eb, [](bool x, bool y, bool) { return x != y; });
    check(~ea, [](bool x, bool, bool) { return !x; });
    check(ea | (eb - ec), [](bool x, bool y, bool z) { return x || (y && !z); });
    check(~(ea ^ ec) & (eb | ~ea), [](bool x, bool y, bool z) { return x == z && (y || !x); });
    check((ea & ~ea) | (ec & ec), [](bool, bool, bool z) { return z; });
  }
  EXPECT_GT(mixed, 1600) << "too few results were neither empty nor full for this test to mean anything";
}

TEST(Combine, SharesWhatASingleOperandDecides) {
  const Universe universe = unit_universe(7);
  Dense dense(128);
  dense.for_each([&](const glm::ivec3& v) { dense.at(v) = (v.x * 7 + v.y * 3 + v.z * 5) % 11 < 4; });
  const Octree noise = tests::octree_of(universe, dense);
  const Octree cut = combine(universe, Expression(noise) - Box{{0, 0, 0}, {9, 9, 9}});
  // Away from the box, the very same nodes.
  const int height = noise.root_height();
  ASSERT_EQ(height, 4);
  EXPECT_EQ(cut.root().child(child_index(1, 1, 1)).node(), noise.root().child(child_index(1, 1, 1)).node());
  EXPECT_NE(cut.root().child(0).node(), noise.root().child(0).node());
}

TEST(Combine, PrimitivesTakeTheVoxelsWhoseCentreTheyContain) {
  const Universe universe = universe_around({{-20, -20, -20}, {20, 20, 20}}, 1.25);
  const Lattice lattice = universe.lattice();
  const HalfSpace half_space{glm::normalize(glm::dvec3(1, 2, -3)), 1.7};
  expect_voxels(combine(universe, half_space), [&](const glm::ivec3& v) {
    return glm::dot(lattice.lps_mm(glm::dvec3(v)), half_space.normal) <= half_space.offset_mm;
  });
  const Sphere sphere{{1.3, -4, 2.2}, 9.4};
  expect_voxels(combine(universe, sphere), [&](const glm::ivec3& v) {
    return glm::distance(lattice.lps_mm(glm::dvec3(v)), sphere.centre_mm) <= sphere.radius_mm;
  });
  const Box box{{-3, -8, 1}, {12.5, 0.3, 9}};
  expect_voxels(combine(universe, box), [&](const glm::ivec3& v) {
    const glm::dvec3 p = lattice.lps_mm(glm::dvec3(v));
    return glm::all(glm::greaterThanEqual(p, box.low_mm)) && glm::all(glm::lessThanEqual(p, box.high_mm));
  });
}

TEST(Combine, AMaskIsTheIntersectionOfItsRegionsBackProjectionsHolesIncluded) {
  const Universe universe = universe_around({{-32, -32, -32}, {32, 32, 32}}, 1.0);
  const Lattice lattice = universe.lattice();
  RegionMask mask;
  mask.regions.push_back(
      {parse_view("anterior"),
       {{{-20.2, -9}, {18, -14.3}, {22, 11}, {3, 25}, {-17, 12}}, {{-5, -4}, {6, -5}, {2, 6}}}});
  mask.regions.push_back({parse_view("30,20"), {{{-15, -18}, {17, -12}, {9, 21}}}});
  const Octree octree = combine(universe, mask);
  expect_voxels(octree, [&](const glm::ivec3& v) { return contains(mask, lattice.lps_mm(glm::dvec3(v))); });
  EXPECT_GT(octree.voxel_count(), 1000U);
  // Drawn in the anterior view, u is the patient's left: mirrored, the mask is another one.
  for (glm::dvec2& point : mask.regions.front().polygons_mm.front()) point.x = -point.x;
  EXPECT_FALSE(combine(universe, mask) == octree);
}

TEST(Combine, ADrawingOfManyPointsHoldsTheVoxelsThatAllItsEdgesEnclose) {
  const Universe universe = universe_around({{-32, -32, -32}, {32, 32, 32}}, 1.0);
  const Lattice lattice = universe.lattice();
  Region ragged{parse_view("20,-10"), {{}}};
  for (int k = 0; k < 1500; ++k) {
    const double turn = 2.0 * std::numbers::pi * k / 1500, radius = 20 + 6 * std::cos(9 * turn) + k % 7;
    ragged.polygons_mm[0].push_back(radius * glm::dvec2(std::cos(turn), std::sin(turn)));
  }
  // On whole millimetres, so that edges run along rows of voxels; a hole and many islands.
  Region square{parse_view("anterior"),
                {{{-20, -20}, {20, -20}, {20, 20}, {-20, 20}}, {{-8, -8}, {8, -8}, {8, 8}}}};
  for (double x = -31; x < 31; x += 2) square.polygons_mm.push_back({{x, 22}, {x + 1, 22}, {x + 1, 30}});
  for (const RegionMask& mask : {RegionMask{{ragged}}, RegionMask{{square}}, RegionMask{{ragged, square}}}) {
    const Octree octree = combine(universe, mask);
    expect_voxels(octree, [&](const glm::ivec3& v) { return contains(mask, lattice.lps_mm(glm::dvec3(v))); });
    EXPECT_GT(octree.voxel_count(), 1000U);
  }
}

TEST(Combine, AMovedObjectIsTheStillOneSampledAtTheCentreMovedBack) {
  const Universe universe = unit_universe(6);
  const Lattice lattice = universe.lattice();
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Octree still = tests::octree_of(universe, tests::random_dense(64, seed + 5));
    Motion motion;
    motion.degrees = 7.0 + 31.0 * static_cast<double>(seed);
    motion.axis = {1.0 + static_cast<double>(seed % 3), -0.4, 0.3 * static_cast<double>(seed % 5)};
    motion.about_mm = {20, 31.3, 40};
    motion.translate_mm = {3.2, -1.7, 0.45};
    const glm::dmat4 matrix = moved_from_still(motion);
    const glm::dmat4 still_from_moved = glm::inverse(matrix);
    expect_voxels(combine(universe, moved(still, matrix)), [&](const glm::ivec3& v) {
      const glm::dvec3 p(still_from_moved * glm::dvec4(lattice.lps_mm(glm::dvec3(v)), 1.0));
      return still.contains(glm::ivec3(glm::floor(lattice.voxel(p) + 0.5)));
    });
  }
}

TEST(Combine, OperandsTogetherGiveWhatTheyGiveApart) {
  const Universe universe = unit_universe(6);
  const glm::dvec3 middle(31.3, 32.1, 30.7);
  // A turned shell has leaves of all kinds: empty, full and passed by its surface.
  const Octree still = combine(universe, Expression(Sphere{middle, 27.0}) - Sphere{middle, 18.5});
  const Expression shell = moved(still, moved_from_still({{1.3, -2.2, 0.6}, 17.0, {1, 2, -1}, middle}));
  const Expression ball = moved(combine(universe, Sphere{middle + 9.0, 16.0}),
                                moved_from_still({{-1.7, 0.4, 2.9}, -31.0, {0, 1, 1}, middle}));
  RegionMask regions;
  for (const char* name : {"anterior", "left"}) {
    const View view = parse_view(name);
    const glm::dvec2 p = view.project(middle);
    regions.regions.push_back(
        {view, {{p + glm::dvec2(-25, -14), p + glm::dvec2(19, -17), p + glm::dvec2(22, 21)}}});
  }
  const Expression mask = regions;
  const Expression apart[3] = {combine(universe, shell), combine(universe, mask), combine(universe, ball)};
  const auto check = [&](const auto& rule) {
    const Octree together = combine(universe, rule(shell, mask, ball));
    EXPECT_TRUE(together == combine(universe, rule(apart[0], apart[1], apart[2])));
    EXPECT_GT(together.voxel_count(), 1000u);
  };
  using E = Expression;
  check([](const E& a, const E& b, const E&) { return a & b; });
  check([](const E& a, const E& b, const E&) { return b & a; });
  check([](const E& a, const E& b, const E&) { return a | b; });
  check([](const E& a, const E& b, const E&) { return a - b; });
  check([](const E& a, const E& b, const E&) { return b - a; });
  check([](const E& a, const E& b, const E&) { return a ^ b; });
  check([](const E& a, const E& b, const E& c) { return (a & b) | (c - a); });
  check([](const E& a, const E& b, const E& c) { return (a ^ b) & (c | ~a); });
}

TEST(Combine, WholeVoxelTranslationsAreExactAndComposeBeforeSampling) {
  const Universe universe = universe_around({{0, 0, 0}, {64, 64, 64}}, 0.7);
  const Octree still = tests::octree_of(universe, tests::random_dense(128, 77));
  const auto shifted = [&](const glm::ivec3& by) {
    Motion motion;
    motion.translate_mm = 0.7 * glm::dvec3(by);
    return moved_from_still(motion);
  };
  const Octree there = combine(universe, moved(still, shifted({5, -3, 17})));
  for (int i = 0; i < 2000; ++i) {
    const glm::ivec3 v((i * 37) % 128, (i * 91) % 128, (i * 53) % 128);
    ASSERT_EQ(there.contains(v), still.contains(v - glm::ivec3(5, -3, 17)));
  }
  // Half a voxel there and half back is no sampling at all; evaluated in between, it would be one.
  Motion half;
  half.translate_mm = glm::dvec3(0.35, 0.35, 0.35);
  Motion back;
  back.translate_mm = -half.translate_mm;
  EXPECT_TRUE(combine(universe, moved(moved(still, moved_from_still(half)), moved_from_still(back))) ==
              still);
}

TEST(Combine, AnObjectTurnedTowardsThePatientsLeftGoesTowardsPlusX) {
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  const Octree ball = combine(universe, Sphere{{0, -10, 0}, 3});
  Motion turn;
  turn.degrees = 90;
  turn.axis = {0, 0, 1};
  // Right-handed about the axis to the head: from the front (-y) to the patient's left (+x).
  EXPECT_TRUE(combine(universe, moved(ball, moved_from_still(turn))) ==
              combine(universe, Sphere{{10, 0, 0}, 3}));
}

TEST(Combine, AGreyWindowIsTheOctreeOfItsSamples) {
  const Universe universe = unit_universe(6);
  Scene scene;
  scene.lattice = universe.lattice();
  voxel::Int16Samples samples;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        samples.push_back(
            static_cast<std::int16_t>(1000.0 * std::sin(0.11 * x) * std::cos(0.07 * y) * std::sin(0.2 * z)));
  scene.samples = samples;
  const GreyOctree grey = grey_octree_of(universe, scene);
  for (const double low : {-900.0, -200.0, 0.0, 400.0, 999.0}) {
    const Octree window = combine(universe, Window{grey, low, low + 500.0});
    EXPECT_TRUE(window == octree_of_window(universe, scene, low, low + 500.0)) << "from " << low;
  }
}

TEST(Combine, AMovedWindowIsInterpolatedAtTheCentreMovedBack) {
  const Universe universe = universe_around({{-20, -20, -20}, {20, 20, 20}}, 0.625);
  const Lattice lattice = universe.lattice();
  Scene scene;
  scene.lattice = lattice;
  voxel::Int16Samples samples;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        samples.push_back(
            static_cast<std::int16_t>(900.0 * std::sin(0.13 * x + 0.05 * z) * std::cos(0.09 * y) + 3.0 * z));
  scene.samples = samples;
  const GreyOctree grey = grey_octree_of(universe, scene, -2000);
  Motion motion;
  motion.degrees = 23;
  motion.axis = {0.3, 1, -0.6};
  motion.translate_mm = {1.1, -0.3, 2.7};
  const glm::dmat4 still_from_moved = glm::inverse(moved_from_still(motion));
  const Octree octree = combine(universe, moved(Window{grey, 250, 700}, moved_from_still(motion)));
  std::uint64_t inside = 0;
  for (int z = 0; z < 64; ++z)
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const glm::dvec3 p_mm = lattice.lps_mm(glm::dvec3(x, y, z));
        const glm::dvec3 p = lattice.voxel(glm::dvec3(still_from_moved * glm::dvec4(p_mm, 1.0)));
        // Border samples run into the background there; interpolate() of a scene keeps them instead.
        if (glm::any(glm::lessThan(p, glm::dvec3(0.0))) || glm::any(glm::greaterThan(p, glm::dvec3(63.0))))
          continue;
        const double value = interpolate(scene, p);
        // Where the value meets the window's ends but for rounding, either answer is right.
        if (std::abs(value - 250) < 1e-9 || std::abs(value - 700) < 1e-9) continue;
        ASSERT_EQ(octree.contains({x, y, z}), value >= 250 && value <= 700) << x << ' ' << y << ' ' << z;
        inside += value >= 250 && value <= 700;
      }
  EXPECT_GT(inside, 10000U);
}

TEST(Combine, AMovedWindowOfCoarseVoxelsIsInterpolatedOnceFromItsScan) {
  // Sheets one sample thick among waves; padding behind a slanted face; voxels of twice to four times the
  // samples.
  auto scene = std::make_shared<Scene>();
  scene->lattice = axis_aligned_lattice({71, 58, 44}, {0.5, 0.6, 0.9}, {-17.2, -16.7, -19.1});
  Int16Samples samples;
  for (int z = 0; z < 44; ++z)
    for (int y = 0; y < 58; ++y)
      for (int x = 0; x < 71; ++x)
        samples.push_back(static_cast<std::int16_t>(x + y > 110  ? -3000
                                                    : x % 9 == 4 ? 1000.0
                                                                 : 300.0 * std::sin(0.2 * y + 0.1 * z)));
  scene->samples = samples;
  scene->padding = -3000.0;
  const Universe universe = universe_around({{-24, -24, -24}, {24, 24, 24}}, 1.9);
  const GreyOctree coarse = grey_octree_of(universe, *scene, -3000);
  const GreyOctree grey = coarse.with_scan(scene);
  Motion motion;
  motion.degrees = 14;
  motion.axis = {0.2, -0.5, 1};
  motion.translate_mm = {1.3, 0.4, -2.1};
  const glm::dmat4 matrix = moved_from_still(motion);
  const Octree octree = combine(universe, moved(Window{grey, 400.5, 2000}, matrix));
  int inside = 0, compared = 0;
  for (int z = 0; z < universe.side(); ++z)
    for (int y = 0; y < universe.side(); ++y)
      for (int x = 0; x < universe.side(); ++x) {
        const glm::dvec3 p_mm = universe.lattice().lps_mm(glm::dvec3(x, y, z));
        const glm::dvec3 p = scene->lattice.voxel(glm::dvec3(glm::inverse(matrix) * glm::dvec4(p_mm, 1.0)));
        const glm::dvec3 last(scene->lattice.dims - 1);
        if (glm::any(glm::lessThan(p, glm::dvec3(0.0))) || glm::any(glm::greaterThan(p, last))) continue;
        const double value = interpolate(*scene, p);
        // Beside padding the measured samples stand for the others.
        if (value == -3000.0) continue;
        ASSERT_EQ(octree.contains({x, y, z}), value >= 400.5) << x << ' ' << y << ' ' << z;
        inside += value >= 400.5;
        ++compared;
      }
  EXPECT_GT(inside, 300);
  EXPECT_GT(compared, 10 * inside / 2);
  EXPECT_FALSE(octree == combine(universe, moved(Window{coarse, 400.5, 2000}, matrix)))
      << "interpolated twice is the same here, so nothing was tested";
  // Whole voxels shift what stands still.
  motion = {};
  motion.translate_mm = {1.9, 0, -3.8};
  const Octree still = combine(universe, Window{grey, 400.5, 2000});
  EXPECT_TRUE(combine(universe, moved(Window{grey, 400.5, 2000}, moved_from_still(motion))) ==
              combine(universe, moved(still, moved_from_still(motion))));
  EXPECT_TRUE(still == combine(universe, Window{coarse, 400.5, 2000}));
}

// Air of -1000 in the box 5..24 x 3..19 x 0..27 of voxels; the background is a value of air, too.
GreyOctree scan_of_air(const Universe& universe) {
  Scene scene;
  scene.lattice = universe.lattice();
  scene.lattice.dims = {20, 17, 28};
  scene.lattice.lps_from_voxel[3] = glm::dvec4(universe.lattice().lps_mm(glm::dvec3(5, 3, 0)), 1.0);
  scene.samples = Int16Samples(scene.lattice.sample_count(), -1000);
  return grey_octree_of(universe, scene, -1024);
}

TEST(Combine, NoWindowHoldsWhatIsBeyondItsScanWhetherItRestsOrMoves) {
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  const GreyOctree grey = scan_of_air(universe);
  const Expression air = Window{grey, -1100, -800};
  const Octree box = octree_of_box(universe, {5, 3, 0}, {24, 19, 27});
  EXPECT_TRUE(combine(universe, air) == box);
  EXPECT_TRUE(combine(universe, ~air) == combine(universe, ~Expression(box)));
  Motion motion;
  motion.degrees = 31;
  motion.axis = {0.3, 1, -0.6};
  motion.translate_mm = {1.1, -0.3, 2.7};
  const glm::dmat4 moved_from_air = moved_from_still(motion);
  for (const auto interpolation : {Interpolation::Nearest, Interpolation::Linear, Interpolation::Cubic})
    EXPECT_TRUE(combine(universe, moved(air, moved_from_air), {Resampling::Voxels::Half, interpolation}) ==
                combine(universe, moved(box, moved_from_air)));
  // Shifted by whole voxels, and seen from a finer universe.
  motion = {};
  motion.translate_mm = {3, -2, 1};
  EXPECT_TRUE(combine(universe, moved(air, moved_from_still(motion))) ==
              octree_of_box(universe, {8, 1, 1}, {27, 17, 28}));
  const Universe fine = universe_around({{-16, -16, -16}, {16, 16, 16}}, 0.5);
  EXPECT_TRUE(combine(fine, air) == octree_of_box(fine, {10, 6, 0}, {49, 39, 55}));
}

TEST(CombineGrey, GivesItsVoxelsAsTheScanOfTheResult) {
  const Universe universe = universe_around({{-16, -16, -16}, {16, 16, 16}}, 1.0);
  const GreyOctree grey = scan_of_air(universe);
  const Expression air = Expression(Window{grey, -1100, -800}) & Sphere{{0, 0, 0}, 9};
  GreyResult options;
  options.background = -1000;  // that of the samples held
  const GreyOctree held = combine_grey(universe, air, options);
  EXPECT_TRUE(held.scan() == combine(universe, air));
  EXPECT_TRUE(combine(universe, Window{held, -2000, 0}) == held.scan());
}

TEST(Combine, AnOctreeOfAFinerUniverseIsSampledAtTheCoarserOnesCentres) {
  const Box box{{-16, -16, -16}, {16, 16, 16}};
  const Sphere ball{{1.1, -2.3, 0.4}, 11.7};
  for (const double finer_mm : {0.25, 0.125}) {
    const Universe coarse = universe_around(box, 1.0);
    const Universe fine = universe_around(box, finer_mm);
    const Octree still = combine(fine, ball);
    const Octree octree = combine(coarse, still);
    expect_voxels(octree, [&](const glm::ivec3& v) {
      const glm::dvec3 p = fine.lattice().voxel(coarse.lattice().lps_mm(glm::dvec3(v)));
      return still.contains(glm::ivec3(glm::floor(p + 0.5)));
    });
  }
}

TEST(Combine, IndexArithmeticHoldsAcrossAUniverseOf4096VoxelsASide) {
  const Universe universe = unit_universe(12);
  const auto block = [](const glm::dvec3& low, const glm::dvec3& high) {
    return Expression(Box{low - 0.5, high + 0.5});
  };
  // Beams along the last row and layer, a slab one voxel thick across the middle, a corner voxel.
  const Octree beam = combine(universe, block({0, 4095, 4095}, {4095, 4095, 4095}));
  const Octree slab = combine(universe, block({0, 0, 2048}, {4095, 4095, 2048}));
  const Octree corner = combine(universe, block({4095, 4095, 4095}, {4095, 4095, 4095}));
  EXPECT_EQ(beam.voxel_count(), 4096U);
  EXPECT_EQ(slab.voxel_count(), 4096U * 4096U);
  EXPECT_EQ(corner.voxel_count(), 1U);
  EXPECT_TRUE(combine(universe, Expression(beam) & corner) == corner);
  EXPECT_EQ(combine(universe, Expression(beam) - corner).voxel_count(), 4095U);
  EXPECT_EQ(combine(universe, Expression(beam) ^ slab).voxel_count(), 4096U * 4097U);
  const Octree complement = combine(universe, ~Expression(corner));
  EXPECT_EQ(complement.voxel_count(), (std::uint64_t{1} << 36) - 1);
  EXPECT_FALSE(complement.contains({4095, 4095, 4095}));
  // Moved by whole voxels from corner to corner, and turned a quarter about the universe's middle.
  Motion across;
  across.translate_mm = glm::dvec3(-4095);
  const Octree first = combine(universe, moved(corner, moved_from_still(across)));
  EXPECT_TRUE(first.contains({0, 0, 0}));
  EXPECT_EQ(first.voxel_count(), 1U);
  Motion quarter;
  quarter.degrees = 90;
  quarter.about_mm = glm::dvec3(2047.5);
  const Octree turned = combine(universe, moved(beam, moved_from_still(quarter)));
  EXPECT_EQ(turned.voxel_count(), 4096U);
  EXPECT_TRUE(turned.contains({0, 0, 4095}) && turned.contains({0, 4095, 4095}));
  const Octree ball = combine(universe, Sphere{{4000.31, 100.23, 3999.57}, 40});
  EXPECT_NEAR(static_cast<double>(ball.voxel_count()), 4.0 / 3.0 * M_PI * 64000, 142);
}

TEST(Combine, GivesTheSameTreeOnOneThreadAndOnTwo) {
  const Universe universe = unit_universe(8);
  const Expression lens = Expression(Sphere{{100, 128, 128}, 70}) & Sphere{{150, 120, 130}, 66};
  Motion motion;
  motion.degrees = 33;
  motion.axis = {1, 1, 0.2};
  motion.about_mm = {128, 128, 128};
  const Octree object = combine(universe, lens);
  const Expression expression =
      moved(object, moved_from_still(motion)) | (Expression(object) - Sphere{{128, 128, 128}, 30});
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return combine(universe, expression);
  };
  EXPECT_TRUE(on(1) == on(2));
}

TEST(CombineGrey, FilledVoxelsOfSamplesInStepsHaveTheirValueInTheScansUnit) {
  const Universe universe = unit_universe(4);
  Scene scene;
  scene.lattice = universe.lattice();
  scene.samples = FloatSamples(4096, 9000.5F);
  const GreyOctree grey = grey_octree_of(universe, scene);
  ASSERT_NE(grey.step(), 1.0);
  std::get<FloatSamples>(scene.samples)[0] = 1.0F;
  const GreyOctree low = grey_octree_of(universe, scene);
  ASSERT_EQ(low.step(), grey.step());
  const Expression all = Expression(window_of(low, 5000.0)) | Expression(Octree::full(universe));
  const GreyOctree made = combine_grey(universe, all);
  EXPECT_NEAR(made.sample({0, 0, 0}) * made.step(), 3071.0, made.step()) << "filled";
  EXPECT_NEAR(made.sample({1, 0, 0}) * made.step(), 9000.5, made.step());
  const GreyOctree other = grey_octree_of_bricks(universe, -1024, {}, [](std::size_t, GreyBrick&) {});
  EXPECT_THROW(combine_grey(universe, all | Expression(window_of(other, 0.0))), std::invalid_argument);
}

TEST(CombineGrey, ASampleIsOfTheOperandThatOwnsTheVoxelInEitherOrder) {
  const Universe universe = unit_universe(4);
  Scene scene;
  scene.lattice = universe.lattice();
  Int16Samples samples(4096);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::int16_t>(i);
  scene.samples = samples;
  const Expression head = Window{grey_octree_of(universe, scene), 0, 32767};
  const Expression cut = octree_of_box(universe, {2, 2, 2}, {6, 6, 6});
  for (const double x_mm : {3.0, 2.5}) {
    Motion motion;
    motion.translate_mm = {x_mm, 0, 0};
    const Expression piece = moved(head & cut, moved_from_still(motion));
    const Expression rest = head - cut;
    const GreyOctree alone = combine_grey(universe, piece);
    const GreyOctree still = combine_grey(universe, rest);
    const auto differing = [&](const Expression& whole, const GreyOctree& first, const GreyOctree& second) {
      const GreyOctree made = combine_grey(universe, whole);
      int count = 0;
      for (int i = 0; i < 4096; ++i) {
        const glm::ivec3 at(i & 15, (i >> 4) & 15, i >> 8);
        const std::int16_t expected = first.scan().contains(at) ? first.sample(at) : second.sample(at);
        count += made.sample(at) != expected ? 1 : 0;
      }
      return count;
    };
    EXPECT_EQ(differing(piece | rest, alone, still), 0) << x_mm;
    EXPECT_EQ(differing(rest | piece, still, alone), 0) << x_mm;
    // The same union as the complement of an intersection.
    EXPECT_EQ(differing(~(~piece & ~rest), alone, still), 0) << x_mm;
    EXPECT_EQ(differing(~(~piece - rest), alone, still), 0) << x_mm;
    const GreyOctree both = combine_grey(universe, piece | rest);
    EXPECT_EQ(both.sample({12, 3, 3}), 12 + 16 * 3 + 256 * 3) << "the rest is not moved";
    EXPECT_FALSE(both.scan().contains({2, 3, 3})) << "the gap behind the piece";
  }
}

}  // namespace
}  // namespace octotomy::voxel
