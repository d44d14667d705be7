// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/line_count.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <tbb/global_control.h>

#include "verify/phantom/chance.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();

/// Samples 100 times the depth below a ball's surface, in millimetres.
std::shared_ptr<const voxel::Scene> ball(double radius_mm, const glm::dvec3& spacing_mm) {
  const glm::ivec3 dims(glm::ceil(2.4 * radius_mm / spacing_mm));
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(dims, spacing_mm, -0.5 * spacing_mm * glm::dvec3(dims - 1));
  voxel::FloatSamples samples(scene.lattice.sample_count());
  std::size_t i = 0;
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x)
        samples[i++] = static_cast<float>(100.0 * (radius_mm - glm::length(scene.lattice.lps_mm({x, y, z}))));
  scene.samples = std::move(samples);
  return std::make_shared<const voxel::Scene>(std::move(scene));
}

double ball_mm3(double radius_mm) {
  return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_mm, 3.0);
}

TEST(LineCount, OfABallIsItsVolumeAndAreaWithinTheScatterThatItStates) {
  for (const glm::dvec3& spacing_mm : {glm::dvec3(1.0), glm::dvec3(0.7, 1.1, 2.0)}) {
    const LineReading reading = lines_in_window(ball(20.0, spacing_mm), 0.0, endless);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const LineCount count = count_along_lines(reading, {.seed = seed});
      EXPECT_NEAR(count.volume_mm3, ball_mm3(20.0), 5.0 * count.deviation_mm3 + 0.004 * ball_mm3(20.0))
          << seed;
      EXPECT_LT(count.deviation_mm3, 0.01 * ball_mm3(20.0)) << seed;
      EXPECT_NEAR(count.area_mm2, 4.0 * std::numbers::pi * 400.0, 0.03 * 4.0 * std::numbers::pi * 400.0)
          << seed;
      // A ball of a fortieth more is another one.
      EXPECT_GT(std::abs(count.volume_mm3 - ball_mm3(20.5)), 5.0 * count.deviation_mm3) << seed;
    }
  }
}

TEST(LineCount, OfAShellCountsBothOfItsSurfaces) {
  const LineCount count = count_along_lines(lines_in_window(ball(20.0, glm::dvec3(1.0)), 0.0, 500.0), {});
  EXPECT_NEAR(count.volume_mm3, ball_mm3(20.0) - ball_mm3(15.0), 0.02 * ball_mm3(20.0));
  EXPECT_NEAR(count.area_mm2, 4.0 * std::numbers::pi * (400.0 + 225.0),
              0.04 * 4.0 * std::numbers::pi * 625.0);
}

/// The share of a scan's volume, up to half a sample beyond the outermost, in which its trilinear interpolant is
/// at least `low`; by a random point in each of `fine` parts of a sample along each axis.
double share_above(const voxel::Scene& scan, double low, int fine) {
  const auto& samples = std::get<voxel::FloatSamples>(scan.samples);
  const glm::ivec3 dims = scan.lattice.dims;
  Chance chance(3);
  const auto at = [&](int number, int axis) {
    return std::clamp((number + chance.between(0.0, 1.0)) / fine - 0.5, 0.0, dims[axis] - 1.0);
  };
  std::size_t above = 0, all = 0;
  for (int z = 0; z < fine * dims.z; ++z)
    for (int y = 0; y < fine * dims.y; ++y)
      for (int x = 0; x < fine * dims.x; ++x, ++all) {
        const glm::dvec3 u(at(x, 0), at(y, 1), at(z, 2));
        const glm::ivec3 first = glm::min(glm::ivec3(u), dims - 2);
        const glm::dvec3 part = u - glm::dvec3(first);
        double value = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
          const glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
          const glm::ivec3 p = first + step;
          const glm::dvec3 weight = glm::mix(1.0 - part, part, glm::dvec3(step));
          value +=
              weight.x * weight.y * weight.z *
              static_cast<double>(samples[static_cast<std::size_t>(p.x + dims.x * (p.y + dims.y * p.z))]);
        }
        above += value >= low ? 1 : 0;
      }
  return static_cast<double>(above) / static_cast<double>(all);
}

TEST(LineCount, ThePeaksOfNoiseKeepTheirVolume) {
  const glm::ivec3 dims(24);
  voxel::Scene scene;
  scene.lattice = voxel::axis_aligned_lattice(dims, glm::dvec3(4.0), glm::dvec3(0.0));
  voxel::FloatSamples samples(scene.lattice.sample_count());
  Chance chance(7);
  for (float& sample : samples) sample = static_cast<float>(chance.between(0.0, 100.0));
  scene.samples = std::move(samples);
  const auto scan = std::make_shared<const voxel::Scene>(std::move(scene));
  const double whole_mm3 = std::pow(24.0 * 4.0, 3.0);
  // The peaks above 70 are a tenth of the volume, and narrower than a sample.
  for (const double low : {50.0, 70.0}) {
    const double share = share_above(*scan, low, 6), truth_mm3 = whole_mm3 * share;
    // The scatter of as many independent points is above that of one point for each part.
    const double truth_deviation_mm3 =
        whole_mm3 * std::sqrt(share * (1.0 - share) / std::pow(6.0 * 24.0, 3.0));
    const LineCount count = count_along_lines(lines_in_window(scan, low, endless), {.lines = 200000});
    EXPECT_LT(count.deviation_mm3, 0.004 * truth_mm3) << low;
    EXPECT_NEAR(count.volume_mm3, truth_mm3, 3.0 * std::hypot(count.deviation_mm3, truth_deviation_mm3))
        << low;
  }
}

TEST(LineCount, IsTheSameOnAnyNumberOfThreads) {
  const LineReading reading = lines_in_window(ball(10.0, glm::dvec3(1.0)), 0.0, endless);
  const LineCount all = count_along_lines(reading, {});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const LineCount alone = count_along_lines(reading, {});
  EXPECT_EQ(all.volume_mm3, alone.volume_mm3);
  EXPECT_EQ(all.deviation_mm3, alone.deviation_mm3);
  EXPECT_EQ(all.crossings, alone.crossings);
}

TEST(LineCount, MovesWithItsObjectBeyondAnyUniverse) {
  const LineReading still = lines_in_window(ball(10.0, glm::dvec3(1.0)), 0.0, endless);
  const double c = std::cos(0.3), s = std::sin(0.3);
  const glm::dmat4 motion(c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 10000, -60, 7, 1);
  const LineCount count =
      count_along_lines(lines_moved(still, motion), {.world_mm = {glm::dvec3(-20), glm::dvec3(20)}});
  EXPECT_NEAR(count.volume_mm3, ball_mm3(10.0), 0.02 * ball_mm3(10.0));
}

/// Whether the expression of each name is true, by Python's precedence, written by hand for each text.
using Truth = bool (*)(bool a, bool b, bool c);

TEST(LineReading, ReadsExpressionsAsPointsDo) {
  const voxel::Box a{{0, 0, 0}, {10, 10, 10}}, b{{4, -2, 3}, {14, 8, 7}}, c{{-3, 5, 5}, {6, 12, 20}};
  const std::map<std::string, LineReading> boxes{
      {"a", lines_in_box(a)}, {"b", lines_in_box(b)}, {"c", lines_in_box(c)}};
  const std::vector<std::pair<const char*, Truth>> texts{
      {"a & b | c", [](bool x, bool y, bool z) { return (x && y) || z; }},
      {"a | b & c", [](bool x, bool y, bool z) { return x || (y && z); }},
      {"a ^ b & c", [](bool x, bool y, bool z) { return x != (y && z); }},
      {"a & b - c", [](bool x, bool y, bool z) { return x && y && !z; }},
      {"a - b - c", [](bool x, bool y, bool z) { return x && !y && !z; }},
      {"a - (b - c)", [](bool x, bool y, bool z) { return x && !(y && !z); }},
      {"a & ~(b | c)", [](bool x, bool y, bool z) { return x && !(y || z); }},
      {"~a & b ^ c", [](bool x, bool y, bool z) { return (!x && y) != z; }},
      {"a ^ b ^ c", [](bool x, bool y, bool z) { return (x != y) != z; }}};
  const auto in = [](const voxel::Box& box, const glm::dvec3& p) {
    return glm::all(glm::greaterThanEqual(p, box.low_mm)) && glm::all(glm::lessThanEqual(p, box.high_mm));
  };
  for (const auto& [text, truth] : texts) {
    const LineReading reading =
        lines_in_expression(text, [&](const std::string& name) { return boxes.at(name); });
    Chance chance(7);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
      const Line line{{chance.between(-5, 15), chance.between(-5, 15), -10.0},
                      glm::normalize(glm::dvec3(chance.even(), chance.even(), 1.0))};
      const Spans spans = reading.inside(line, {{0.0, 40.0}});
      const double at_mm = chance.between(0.0, 40.0);
      const glm::dvec3 p = line.from_mm + at_mm * line.along;
      bool inside = false;
      for (const Span& span : spans) inside = inside || (at_mm >= span.low_mm && at_mm <= span.high_mm);
      EXPECT_EQ(inside, truth(in(a, p), in(b, p), in(c, p))) << text << ", line " << i;
      met += inside ? 1 : 0;
    }
    EXPECT_GT(met, 5) << text;
  }
}

TEST(LineReading, OfAnObjectWithoutItselfHoldsNothing) {
  const auto scan = ball(12.0, {0.9, 1.0, 1.3});
  const double c = std::cos(0.4), s = std::sin(0.4);
  const glm::dmat4 motion(c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 2, -3, 1, 1);
  const LineReading window = lines_in_window(scan, 0.0, endless);
  const LineReading half = lines_in_box({glm::dvec3(-30.0), {30.0, 2.0, 30.0}});
  const std::map<std::string, LineReading> objects{{"a", window},
                                                   {"turned", lines_moved(window, motion)},
                                                   {"half", half},
                                                   {"part", lines_in_both(half, window)},
                                                   {"smaller", lines_in_window(scan, 1.0, endless)}};
  const auto count = [&](const char* text) {
    return count_along_lines(
        lines_in_expression(text, [&](const std::string& name) { return objects.at(name); }),
        {.world_mm = {glm::dvec3(-20), glm::dvec3(20)}});
  };
  for (const char* text :
       {"a - a", "a ^ a", "turned - turned", "part - part", "part - a", "(a & half) - part"}) {
    EXPECT_LT(count(text).volume_mm3, 1e-6) << text;
    EXPECT_LT(count(text).area_mm2, 1.0) << text;
  }
  // A shell of a hundredth of a millimetre is something: 4 pi 12 mm squared times that.
  EXPECT_NEAR(count("a - smaller").volume_mm3, 18.1, 2.0);
}

TEST(LineReading, OfTooManyOperandsThereIsNone) {
  const auto scan = ball(3.0, glm::dvec3(1.0));
  const auto lookup = [&](const std::string&) { return lines_in_window(scan, 0.0, endless); };
  const auto of = [&](int count) {
    std::string text = "a";
    for (int i = 1; i < count; ++i) text += " | a";
    return static_cast<bool>(lines_in_expression(text, lookup));
  };
  EXPECT_TRUE(of(100));
  EXPECT_FALSE(of(50000));
  // Steps that double what they are made of.
  LineReading twice = lookup("a");
  for (int step = 0; step < 60; ++step) twice = lines_in_either(twice, twice);
  EXPECT_FALSE(twice);
  EXPECT_FALSE(lines_in_expression(std::string(100000, '~') + "a", lookup));
}

TEST(LineReading, RefusesTextThatIsNoExpression) {
  for (const char* text : {"", "a b", "a &", "& a", "(a", "a)", "a + a", "a ~ a"})
    EXPECT_THROW(lines_in_expression(text, [](const std::string&) { return lines_in_box({}); }),
                 std::invalid_argument)
        << text;
}

TEST(LineReading, OfARegionIsWhatItsPolygonEnclosesAtAnyDepth) {
  const LineReading ring = lines_in_region(
      {1, 0, 0}, {0, 0, 1}, {{{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {{4, 4}, {6, 4}, {6, 6}, {4, 6}}});
  const Spans across = ring.inside({{-5, 1, 5}, {1, 0, 0}}, {{0, 100}});
  ASSERT_EQ(across.size(), 2U);
  EXPECT_NEAR(across[0].low_mm, 5.0, 1e-9);
  EXPECT_NEAR(across[0].high_mm, 9.0, 1e-9);
  EXPECT_NEAR(across[1].high_mm, 15.0, 1e-9);
  EXPECT_EQ(ring.inside({{5, 0, 5}, {0, 1, 0}}, {{0, 100}}).size(), 0U);
  EXPECT_EQ(ring.inside({{1, 0, 1}, {0, 1, 0}}, {{0, 100}}).size(), 1U);
}

TEST(LineReading, OfSamplesThatAreNoNumberIsOutside) {
  voxel::Scene scene = *ball(6.0, glm::dvec3(1.0));
  for (float& sample : std::get<voxel::FloatSamples>(scene.samples))
    sample = std::numeric_limits<float>::quiet_NaN();
  const auto scan = std::make_shared<const voxel::Scene>(std::move(scene));
  EXPECT_EQ(count_along_lines(lines_in_window(scan, -endless, endless), {}).volume_mm3, 0.0);
}

}  // namespace
}  // namespace octotomy::verify
