// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/chain_code.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

using std::numbers::pi;

Contour circle(double radius, int points) {
  Contour contour;
  for (int k = 0; k < points; ++k)
    contour.points_mm.emplace_back(radius * std::cos(2 * pi * k / points),
                                   radius * std::sin(2 * pi * k / points));
  return contour;
}

TEST(ChainCode, FreemansDirectionsRunCounterClockwiseFromX) {
  const Contour octagon{{{0, 0}, {1, 0}, {2, 1}, {2, 2}, {1, 3}, {0, 3}, {-1, 2}, {-1, 1}}, true};
  const ChainCode code = chain_code(octagon, {1, 1});
  EXPECT_EQ(code.start, glm::ivec2(0, 0));
  EXPECT_EQ(code.steps, (std::vector<std::uint8_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(contour_of(code, {1, 1}).points_mm, octagon.points_mm);
}

TEST(ChainCode, ComesBackWithinHalfASampleAndCodesTheSameAgain) {
  const glm::dvec2 spacing(0.5, 0.8);
  const Contour ring = circle(40, 500);
  const ChainCode code = chain_code(ring, spacing);
  const Contour back = contour_of(code, spacing);
  EXPECT_EQ(back.points_mm.size(), code.steps.size());
  for (const glm::dvec2& p : back.points_mm) EXPECT_NEAR(glm::length(p), 40.0, 0.8);
  EXPECT_NEAR(signed_area_mm2(back), signed_area_mm2(ring), 0.01 * signed_area_mm2(ring));
  const ChainCode again = chain_code(back, spacing);
  EXPECT_EQ(again.start, code.start);
  EXPECT_EQ(again.steps, code.steps);
}

TEST(ChainCode, LengthsAreRightOnTheAverageOfDirections) {
  const double length = chain_length(chain_code(circle(200, 4000), {1, 1}));
  EXPECT_NEAR(length, 2 * pi * 200, 0.01 * 2 * pi * 200);
  // The naive weights 1 and sqrt 2 overstate the length by five per cent.
  double naive = 0.0;
  for (const std::uint8_t step : chain_code(circle(200, 4000), {1, 1}).steps)
    naive += step % 2 == 0 ? 1.0 : std::sqrt(2.0);
  EXPECT_GT(naive, 1.04 * 2 * pi * 200);
}

TEST(ChainCode, RefusesWhatTakesTooManyStepsOrLiesTooFarAway) {
  const Contour far{{{3e6, 3e6}, {3e6 + 10, 3e6}, {3e6, 3e6 + 10}}, true};
  EXPECT_EQ(chain_code(far, {1, 1}).start, glm::ivec2(3000000, 3000000));
  EXPECT_THROW(chain_code(far, {0.001, 0.001}), Error);
  const Contour large{{{0, 0}, {1e6, 0}, {0, 1e6}}, true};
  EXPECT_THROW(chain_code(large, {0.01, 0.01}), Error);
}

TEST(ChainCode, OpenLinesStayOpenAndNonsenseIsRefused) {
  const ChainCode code = chain_code({{{0, 0}, {5, 2}}, false}, {1, 1});
  EXPECT_EQ(code.steps.size(), 5u);
  EXPECT_FALSE(contour_of(code, {1, 1}).closed);
  EXPECT_EQ(contour_of(code, {1, 1}).points_mm.back(), glm::dvec2(5, 2));
  EXPECT_THROW(chain_code({{}, true}, {1, 1}), std::invalid_argument);
  EXPECT_THROW(chain_code({{{0, 0}}, true}, {0, 1}), std::invalid_argument);
  EXPECT_THROW(contour_of({{0, 0}, {0, 8}, true}, {1, 1}), std::invalid_argument);
  EXPECT_THROW(contour_of({{0, 0}, {0, 2}, true}, {1, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
