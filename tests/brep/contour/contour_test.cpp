// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/contour.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace octotomy::brep {
namespace {

using std::numbers::pi;

/// A slice that owns its samples of a function of the plane in mm.
struct Picture {
  Picture(std::uint32_t w, std::uint32_t h, const glm::dvec2& spacing_mm,
          const std::function<double(glm::dvec2)>& f) {
    for (std::uint32_t j = 0; j < h; ++j)
      for (std::uint32_t i = 0; i < w; ++i)
        samples.push_back(static_cast<float>(f(glm::dvec2(i, j) * spacing_mm)));
    slice = {samples, w, h, spacing_mm};
  }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;
  std::vector<float> samples;
  Slice slice;
};

/// Whole numbers from -2 to 2 at random, so that many samples are exactly at the threshold.
Picture noise_of(unsigned seed, std::uint32_t w, std::uint32_t h) {
  std::mt19937 random(seed);
  return {w, h, {1.0, 0.7}, [&](glm::dvec2) { return static_cast<double>(random() % 5) - 2.0; }};
}

/// Signed distance to a circle about (20, 20), positive inside.
auto disc(double radius) {
  return [radius](glm::dvec2 p) { return radius - glm::distance(p, glm::dvec2(20.3, 19.8)); };
}

/// Whether any two pieces of these closed contours that share no end meet.
bool meet(const std::vector<Contour>& contours) {
  struct Piece {
    glm::dvec2 a, b;
    std::size_t contour, k, count;
  };
  std::vector<Piece> pieces;
  for (std::size_t c = 0; c < contours.size(); ++c) {
    const auto& p = contours[c].points_mm;
    for (std::size_t k = 0; k < p.size(); ++k)
      pieces.push_back({p[k], p[(k + 1) % p.size()], c, k, p.size()});
  }
  const auto side = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  };
  for (const Piece& s : pieces)
    for (const Piece& t : pieces) {
      if (s.contour == t.contour && (s.k == t.k || (s.k + 1) % s.count == t.k || (t.k + 1) % t.count == s.k))
        continue;
      // Pieces of one line that are apart have no area in either test; their boxes show that they do not
      // meet.
      if (glm::any(glm::lessThan(glm::max(s.a, s.b), glm::min(t.a, t.b))) ||
          glm::any(glm::lessThan(glm::max(t.a, t.b), glm::min(s.a, s.b))))
        continue;
      if (side(s.a, s.b, t.a) * side(s.a, s.b, t.b) <= 0.0 &&
          side(t.a, t.b, s.a) * side(t.a, t.b, s.b) <= 0.0)
        return true;
    }
  return false;
}

TEST(Contour, ADiscsAreaAndPerimeterConvergeAtSecondOrder) {
  double previous_area = 0.0, previous_perimeter = 0.0;
  for (const double h : {1.0, 0.5, 0.25}) {
    const auto n = static_cast<std::uint32_t>(40.0 / h) + 1;
    const Picture picture(n, n, {h, h}, disc(12.0));
    const auto found = follow(picture.slice, {});
    ASSERT_EQ(found.size(), 1U);
    const double area = std::abs(signed_area_mm2(found[0]) - pi * 144.0);
    const double perimeter = std::abs(perimeter_mm(found[0]) - 24.0 * pi);
    if (h < 1.0) {
      EXPECT_LT(area, previous_area / 3.0) << "spacing " << h;
      EXPECT_LT(perimeter, previous_perimeter / 3.0) << "spacing " << h;
    }
    previous_area = area;
    previous_perimeter = perimeter;
  }
  EXPECT_LT(previous_area, 0.1);
}

TEST(Contour, OuterContoursRunCounterClockwiseHolesClockwiseOnUnequalSpacing) {
  const Picture ring(41, 81, {1.0, 0.5}, [](glm::dvec2 p) {
    return 4.0 - std::abs(glm::distance(p, glm::dvec2(20.3, 19.8)) - 10.0);
  });
  const auto found = follow(ring.slice, {});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(signed_area_mm2(found[0]), pi * 196.0, 3.0);
  EXPECT_NEAR(signed_area_mm2(found[1]), -pi * 36.0, 3.0);
  const auto around = nest(found);
  EXPECT_EQ(around[0], std::nullopt);
  EXPECT_EQ(around[1], 0U);
}

TEST(Contour, AnObjectAtTheBorderIsClosedAtItsPixelsEdgeOrReportedAsOpen) {
  const Picture all(5, 4, {2.0, 3.0}, [](glm::dvec2) { return 1.0; });
  const auto closed = follow(all.slice, {});
  ASSERT_EQ(closed.size(), 1U);
  EXPECT_TRUE(closed[0].closed);
  EXPECT_NEAR(signed_area_mm2(closed[0]), 5 * 2.0 * 4 * 3.0 - 4 * 0.5 * 1.0 * 1.5, 1e-9)
      << "the pixels' area but for the four corners cut";

  const Picture half(6, 4, {1.0, 1.0}, [](glm::dvec2 p) { return 2.5 - p.x; });
  const auto open = follow(half.slice, {0.0, Border::leave_open});
  ASSERT_EQ(open.size(), 1U);
  EXPECT_FALSE(open[0].closed);
  EXPECT_EQ(open[0].points_mm.front(), glm::dvec2(2.5, 0.0)) << "upwards: the object is on the left";
  EXPECT_EQ(open[0].points_mm.back(), glm::dvec2(2.5, 3.0));
  EXPECT_THROW(signed_area_mm2(open[0]), std::invalid_argument);
}

TEST(Contour, DiagonalCornersJoinAsTheBilinearInterpolantDoes) {
  const auto count = [](double weight) {
    const Picture saddle(4, 4, {1.0, 1.0}, [&](glm::dvec2 p) {
      if (p == glm::dvec2(1, 1) || p == glm::dvec2(2, 2)) return weight;
      return -1.0;
    });
    return follow(saddle.slice, {}).size();
  };
  EXPECT_EQ(count(2.0), 1U);
  EXPECT_EQ(count(0.5), 2U);
}

TEST(Contour, NoiseWithSamplesExactlyAtTheThresholdGivesContoursThatNeverMeet) {
  std::size_t at_threshold = 0, contours = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Picture noise = noise_of(seed, 9, 8);
    for (const float s : noise.samples) at_threshold += s == 0.0F ? 1 : 0;
    const auto found = follow(noise.slice, {});
    contours += found.size();
    EXPECT_FALSE(meet(found)) << "seed " << seed;
    // A contour's direction depends on its depth, so the depth by nesting must alternate with the direction.
    const auto around = nest(found);
    for (std::size_t c = 0; c < found.size(); ++c) {
      const bool is_hole = signed_area_mm2(found[c]) < 0.0;
      EXPECT_EQ(is_hole, around[c] && signed_area_mm2(found[*around[c]]) > 0.0) << "seed " << seed;
    }
  }
  EXPECT_GT(at_threshold, 100U);
  EXPECT_GT(contours, 100U);
  const Contour eight{{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, true};
  EXPECT_TRUE(meet({eight})) << "the check of this test sees a contour that crosses itself";
}

TEST(Contour, WhatIsNoSliceIsRefused) {
  Picture picture(3, 3, {1.0, 1.0}, [](glm::dvec2) { return 0.0; });
  picture.samples[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(follow(picture.slice, {}), std::invalid_argument);
  picture.samples[4] = 0.0F;
  EXPECT_NO_THROW(follow(picture.slice, {}));
  picture.slice.width = 4;
  EXPECT_THROW(follow(picture.slice, {}), std::invalid_argument);
}

/// Nesting by its definition, for contours that do not touch: the smallest larger contour that a ray from a
/// point of the contour leaves, over all pieces of all contours.
std::vector<std::optional<std::size_t>> plainly_nested(const std::vector<Contour>& contours) {
  std::vector<std::optional<std::size_t>> around(contours.size());
  const auto area = [&](std::size_t c) { return std::abs(signed_area_mm2(contours[c])); };
  for (std::size_t c = 0; c < contours.size(); ++c)
    for (std::size_t o = 0; o < contours.size(); ++o) {
      const glm::dvec2 p = contours[c].points_mm[0];
      const auto& q = contours[o].points_mm;
      bool inside = false;
      for (std::size_t a = q.size() - 1, b = 0; b < q.size(); a = b++)
        if ((q[a].y > p.y) != (q[b].y > p.y))
          inside ^= p.x < q[a].x + (p.y - q[a].y) / (q[b].y - q[a].y) * (q[b].x - q[a].x);
      if (o != c && inside && area(o) > area(c) && (!around[c] || area(o) < area(*around[c]))) around[c] = o;
    }
  return around;
}

TEST(Nest, ManyContoursOfNoiseAreNestedAsALookAtAllPiecesNestsThem) {
  std::size_t nested = 0, deepest = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Picture noise = noise_of(seed, 60, 50);
    const auto found = follow(noise.slice, {});
    const auto around = nest(found);
    ASSERT_EQ(around, plainly_nested(found)) << "seed " << seed;
    const std::vector<std::size_t> depth = depths(around);
    for (std::size_t c = 0; c < found.size(); ++c) {
      std::size_t count = 0;
      for (auto outer = around[c]; outer; outer = around[*outer]) ++count;
      ASSERT_EQ(depth[c], count) << "seed " << seed << ", contour " << c;
      nested += around[c].has_value();
      deepest = std::max(deepest, count);
    }
  }
  EXPECT_GT(nested, 1000U);
  EXPECT_GT(deepest, 2U);
  EXPECT_TRUE(nest({}).empty());
}

TEST(Nest, ContoursThatTouchAreNestedByWhatTheyEnclose) {
  const Contour whole{{{0, 0}, {10, 0}, {10, 10}, {0, 10}}}, corner{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}},
      beside{{{10, 0}, {12, 0}, {12, 10}, {10, 10}}}, half{{{0, 0}, {4, 0}, {4, 4}}},
      other{{{0, 0}, {4, 4}, {0, 4}}};
  using Around = std::vector<std::optional<std::size_t>>;
  EXPECT_EQ(nest({whole, corner, beside}), (Around{std::nullopt, 0, std::nullopt}));
  EXPECT_EQ(nest({beside, corner, whole}), (Around{std::nullopt, 2, std::nullopt}));
  EXPECT_EQ(nest({half, other}), (Around{std::nullopt, std::nullopt}));
  EXPECT_EQ(nest({half, corner, whole, other}), (Around{1, 2, std::nullopt, 1}));
  EXPECT_EQ(depths(nest({half, corner, whole, other})), (std::vector<std::size_t>{2, 1, 0, 2}));
}

}  // namespace
}  // namespace octotomy::brep
