// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/thin.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

namespace octotomy::brep {
namespace {

using Points = std::vector<glm::dvec2>;

double distance_to_piece(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * along);
}

/// Thinning by its definition: each piece extends as long as every point that it passes, tested one by one,
/// allows it.
Contour plainly_thin(const Contour& contour, double limit_mm, std::size_t& longest) {
  const Points& p = contour.points_mm;
  const std::size_t least = contour.closed ? 3 : 2, end = p.size() - (contour.closed ? 0 : 1);
  if (p.size() <= least) return contour;
  Contour kept{{}, contour.closed};
  for (std::size_t anchor = 0, reached = 0; anchor < end; anchor = reached) {
    kept.points_mm.push_back(p[anchor]);
    const auto fits = [&](std::size_t candidate) {
      for (std::size_t k = anchor + 1; k < candidate; ++k)
        if (distance_to_piece(p[k], p[anchor], p[candidate % p.size()]) > limit_mm) return false;
      return true;
    };
    for (reached = anchor + 1; reached < end && fits(reached + 1);) ++reached;
    longest = std::max(longest, reached - anchor);
  }
  if (!contour.closed) kept.points_mm.push_back(p.back());
  return kept.points_mm.size() < least ? contour : kept;
}

/// A circle with noise, a staircase, a line walked to and fro, steps at random, and points that repeat.
Points points_of(unsigned kind, std::mt19937& random) {
  const auto any = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
  Points points;
  const std::size_t count = 1 + random() % 300;
  glm::dvec2 at(any(100) - 50, any(100) - 50);
  for (std::size_t k = 0; k < count; ++k) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    switch (kind) {
      case 0:
        points.push_back((20.0 + any(0.5)) * glm::dvec2(std::cos(turn), std::sin(turn)));
        break;
      case 1:
        points.emplace_back(k / 2, (k + 1) / 2 % 2 + (k % 40 == 39 ? 1 : 0));
        break;
      case 2:
        points.push_back(at += (any(3) - 1.0) * glm::dvec2(0.8, 0.6));
        break;
      case 3:
        points.push_back(at += glm::dvec2(any(2) - 0.7, any(2) - 1.0));
        break;
      default:
        points.push_back(random() % 3 == 0 ? at : at += glm::dvec2(random() % 3, random() % 2));
    }
  }
  return points;
}

TEST(Thin, LeavesOutThePointsThatTheDefinitionDoes) {
  std::size_t left_out = 0, longest = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    std::mt19937 random(seed);
    const Contour contour{points_of(seed % 5, random), random() % 2 == 0};
    for (const double limit_mm : {0.0, 1e-300, 1e-13, 1e-9, 0.05, 0.5, 1.0, std::sqrt(0.5), 3.0, 30.0, 1e6}) {
      const Contour found = thin(contour, limit_mm), truth = plainly_thin(contour, limit_mm, longest);
      ASSERT_EQ(found.points_mm, truth.points_mm) << "seed " << seed << ", " << limit_mm << " mm";
      ASSERT_EQ(found.closed, contour.closed);
      left_out += contour.points_mm.size() - truth.points_mm.size();
    }
  }
  EXPECT_GT(left_out, 100000U);
  EXPECT_GT(longest, 250U);
}

TEST(Thin, LeavesNothingFurtherAwayThanItWasAllowed) {
  Contour full;
  for (int k = 0; k < 120; ++k)
    full.points_mm.push_back(
        15.0 * glm::dvec2(std::cos(k * std::numbers::pi / 60), std::sin(k * std::numbers::pi / 60)));
  const Contour few = thin(full, 0.2);
  EXPECT_LT(few.points_mm.size(), full.points_mm.size() / 3);
  EXPECT_LT(std::abs(signed_area_mm2(few) - signed_area_mm2(full)), 0.2 * perimeter_mm(full));
  for (const glm::dvec2& p : full.points_mm) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < few.points_mm.size(); ++k) {
      const glm::dvec2 a = few.points_mm[k], d = few.points_mm[(k + 1) % few.points_mm.size()] - a;
      const double t = std::clamp(glm::dot(p - a, d) / glm::dot(d, d), 0.0, 1.0);
      nearest = std::min(nearest, glm::distance(p, a + t * d));
    }
    EXPECT_LE(nearest, 0.2 * (1.0 + 1e-12));
  }
  const Contour square{{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, true};
  EXPECT_EQ(thin(square, 0.0).points_mm, (std::vector<glm::dvec2>{{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
  EXPECT_THROW(thin(square, -1.0), std::invalid_argument);
}

}  // namespace
}  // namespace octotomy::brep
