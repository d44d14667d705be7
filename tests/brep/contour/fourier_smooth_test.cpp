// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/fourier_smooth.h"

#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <stdexcept>

namespace octotomy::brep {
namespace {

using std::numbers::pi;

/// Smoothing by its definition: each coefficient is summed over all pieces, each point over all coefficients.
/// Waves are computed from the remainder of whole turns, so that many turns lose no digits.
Contour plainly_smooth(const Contour& contour, const FourierOptions& options) {
  using Complex = std::complex<double>;
  const auto& p = contour.points_mm;
  const double length = perimeter_mm(contour);
  const auto wave = [](double turns) { return std::polar(1.0, 2.0 * pi * (turns - std::round(turns))); };
  const auto kept = static_cast<std::ptrdiff_t>(options.harmonics);
  const auto count = static_cast<std::ptrdiff_t>(options.points);
  std::vector<Complex> points(options.points);
  for (std::ptrdiff_t k = -kept; k <= kept; ++k) {
    Complex sum = 0.0;
    double along = 0.0;
    for (std::size_t a = 0; a < p.size(); ++a) {
      const glm::dvec2 from = p[a], to = p[(a + 1) % p.size()];
      const double step = glm::distance(from, to), turns = static_cast<double>(k) / length;
      if (step == 0.0) continue;
      const Complex middle(0.5 * (from.x + to.x), 0.5 * (from.y + to.y));
      const Complex slope = Complex(to.x - from.x, to.y - from.y) / step;
      sum += k == 0 ? middle * step : slope * (wave(-turns * (along + step)) - wave(-turns * along));
      along += step;
    }
    const double angular = 2.0 * pi * static_cast<double>(k);
    const Complex coefficient = k == 0 ? sum / length : sum * (length / (angular * angular));
    for (std::ptrdiff_t n = 0; n < count; ++n)
      points[static_cast<std::size_t>(n)] +=
          coefficient * wave(static_cast<double>(k * n % count) / static_cast<double>(count));
  }
  Contour smooth;
  for (const Complex& z : points) smooth.points_mm.emplace_back(z.real(), z.imag());
  return smooth;
}

TEST(FourierSmooth, GivesThePointsOfTheDefinitionButForRounding) {
  double farthest = 0.0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    std::mt19937 random(seed);
    const auto any = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
    Contour contour;
    for (std::size_t k = 2 + random() % (seed % 2 == 0 ? 6 : 400); k > 0; --k) {
      contour.points_mm.emplace_back(100.0 + any(60), any(60) - 200.0);
      if (random() % 8 == 0) contour.points_mm.push_back(contour.points_mm.back());  // no length
    }
    const std::size_t harmonics = 1 + random() % (seed % 3 == 0 ? 200 : 20);
    const FourierOptions options{harmonics, 2 * harmonics + 1 + random() % 300};
    const Contour found = fourier_smooth(contour, options), truth = plainly_smooth(contour, options);
    ASSERT_EQ(found.points_mm.size(), options.points);
    const double size = perimeter_mm(contour) + 300.0;
    for (std::size_t n = 0; n < options.points; ++n) {
      const double away = glm::distance(found.points_mm[n], truth.points_mm[n]);
      ASSERT_LT(away, 1e-13 * size) << "seed " << seed << ", point " << n;
      farthest = std::max(farthest, glm::distance(found.points_mm[n], found.points_mm[0]));
    }
  }
  EXPECT_GT(farthest, 10.0);
}

TEST(FourierSmooth, MoreHarmonicsThanTheContourHasPointsBringACornerNearerStill) {
  const Contour square{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}};
  double before = 0.0;
  for (const std::size_t harmonics : {8U, 80U, 800U, 8000U}) {
    const Contour smooth = fourier_smooth(square, {harmonics, 4 * harmonics});
    const double away = glm::distance(smooth.points_mm[0], square.points_mm[0]);
    // The dropped harmonics fall with the square of their number, so their sum falls with the number.
    if (before > 0.0) {
      EXPECT_NEAR(before / away, 10.0, 1.0) << harmonics;
    }
    before = away;
  }
}

TEST(FourierSmooth, TakesARippleOffACircleAndLeavesTheCircle) {
  Contour rippled;
  for (int k = 0; k < 720; ++k) {
    const double a = 2.0 * pi * k / 720.0, r = 10.0 + 0.05 * std::cos(40.0 * a);
    rippled.points_mm.emplace_back(5.0 + r * std::cos(a), -3.0 + r * std::sin(a));
  }
  const auto roughness = [](const Contour& c) {
    double worst = 0.0;
    for (const glm::dvec2& p : c.points_mm)
      worst = std::max(worst, std::abs(glm::distance(p, glm::dvec2(5.0, -3.0)) - 10.0));
    return worst;
  };
  EXPECT_GT(roughness(rippled), 0.049);
  const Contour smooth = fourier_smooth(rippled, {4, 200});
  EXPECT_LT(roughness(smooth), 0.03) << "arc length follows the ripple, and shrinks the circle by its share";
  EXPECT_GT(roughness(fourier_smooth(rippled, {60, 720})), 0.04) << "harmonics kept keep the ripple";
  EXPECT_GT(signed_area_mm2(smooth), 0.0) << "direction is kept";
  EXPECT_THROW(fourier_smooth(rippled, {4, 8}), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
