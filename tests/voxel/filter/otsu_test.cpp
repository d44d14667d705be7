// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/otsu.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>

namespace octotomy::voxel {
namespace {

// Variance within the classes of given thresholds, by definition.
double within(const Histogram& histogram, const std::vector<std::size_t>& firsts) {
  double sum = 0.0;
  for (std::size_t c = 0; c <= firsts.size(); ++c) {
    const std::size_t from = c == 0 ? 0 : firsts[c - 1];
    const std::size_t to = c == firsts.size() ? histogram.counts.size() : firsts[c];
    double n = 0, mean = 0;
    for (std::size_t i = from; i < to; ++i) {
      n += static_cast<double>(histogram.counts[i]);
      mean += static_cast<double>(histogram.counts[i] * i);
    }
    if (n == 0) continue;
    mean /= n;
    for (std::size_t i = from; i < to; ++i)
      sum += static_cast<double>(histogram.counts[i]) * std::pow(static_cast<double>(i) - mean, 2);
  }
  return sum;
}

double least_within(const Histogram& histogram, int classes) {
  double least = INFINITY;
  std::vector<std::size_t> firsts;
  const std::function<void(std::size_t)> choose = [&](std::size_t from) {
    if (firsts.size() + 1 == static_cast<std::size_t>(classes)) {
      least = std::min(least, within(histogram, firsts));
      return;
    }
    for (std::size_t next = from; next < histogram.counts.size(); ++next) {
      firsts.push_back(next);
      choose(next + 1);
      firsts.pop_back();
    }
  };
  choose(1);
  return least;
}

std::vector<std::size_t> bins_of(const Histogram& histogram, const std::vector<double>& thresholds) {
  std::vector<std::size_t> bins;
  for (const double threshold : thresholds)
    bins.push_back(
        static_cast<std::size_t>(std::lround((threshold - histogram.low) / histogram.width() + 0.5)));
  return bins;
}

TEST(Otsu, PartsThreePeaksBetweenThem) {
  Histogram peaks{-1000, 1000, std::vector<std::uint64_t>(201, 0)};  // bins 10 apart
  const auto hill = [&](int centre, std::uint64_t height) {
    for (int i = -20; i <= 20; ++i)
      peaks.counts[static_cast<std::size_t>(centre + i)] +=
          height * static_cast<std::uint64_t>(1000 * std::exp(-0.02 * i * i));
  };
  hill(30, 1), hill(100, 1), hill(170, 1);
  const std::vector<double> thresholds = otsu_thresholds(peaks, 3);
  ASSERT_EQ(thresholds.size(), 2U);
  // Hills end 18 bins from their middles; any place in the empty gap is as good.
  EXPECT_GE(thresholds[0], -520);
  EXPECT_LE(thresholds[0], -180);
  EXPECT_GE(thresholds[1], 180);
  EXPECT_LE(thresholds[1], 520);
}

TEST(Otsu, TwoEqualOverlappingHillsArePartedHalfWay) {
  Histogram hills{0, 255, std::vector<std::uint64_t>(256, 0)};
  for (int i = 0; i < 256; ++i)
    hills.counts[static_cast<std::size_t>(i)] = static_cast<std::uint64_t>(
        1e6 * (std::exp(-std::pow((i - 90) / 30.0, 2) / 2) + std::exp(-std::pow((i - 165) / 30.0, 2) / 2)));
  EXPECT_NEAR(otsu_thresholds(hills, 2)[0], 127.5, 1.0);
}

TEST(Otsu, FindsTheLeastVarianceThatASearchThroughAllFinds) {
  int spoiled = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    Histogram histogram{-50, 50, {}};
    const std::size_t bins = 6 + random() % 8;
    for (std::size_t i = 0; i < bins; ++i) histogram.counts.push_back(random() % 4 == 0 ? 0 : random() % 100);
    const int classes = 2 + static_cast<int>(seed % 4);
    const std::vector<std::size_t> found = bins_of(histogram, otsu_thresholds(histogram, classes));
    const double truth = least_within(histogram, classes);
    EXPECT_NEAR(within(histogram, found), truth, 1e-9 * (1 + truth));
    // Moved by a bin it is no longer the least, where the bin that changes sides holds any sample.
    std::vector<std::size_t> moved = found;
    ++moved.back();
    if (moved.back() < bins && histogram.counts[found.back()] > 0)
      spoiled += within(histogram, moved) > truth * (1 + 1e-9) + 1e-9;
  }
  EXPECT_GT(spoiled, 20);
}

TEST(Otsu, RefusesClassesThatCannotBe) {
  const Histogram histogram{0, 3, {1, 2, 3, 4}};
  EXPECT_THROW(otsu_thresholds(histogram, 1), std::invalid_argument);
  EXPECT_THROW(otsu_thresholds(histogram, 9), std::invalid_argument);
  EXPECT_THROW(otsu_thresholds(histogram, 5), std::invalid_argument);
  EXPECT_EQ(otsu_thresholds(histogram, 4), (std::vector<double>{0.5, 1.5, 2.5}));
}

}  // namespace
}  // namespace octotomy::voxel
