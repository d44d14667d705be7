// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/histogram.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::voxel {
namespace {

// About a million samples at equal steps, in ascending order; all samples if there are fewer. Padding is left
// out unless all samples are padding.
template <typename Sample>
std::vector<Sample> sorted(const Samples<Sample>& samples, std::optional<double> padding) {
  constexpr std::size_t enough = 1'000'000;
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / enough);
  std::vector<Sample> some;
  some.reserve(samples.size() / stride + 1);
  for (std::size_t i = 0; i < samples.size(); i += stride)
    if (static_cast<double>(samples[i]) != padding) some.push_back(samples[i]);
  if (some.empty()) some.push_back(samples.front());
  std::sort(some.begin(), some.end());
  return some;
}

// The number of samples with each possible value. Padding is left out unless all samples are padding.
std::vector<std::uint64_t> counts_of_values(const Int16Samples& samples, std::optional<double> padding) {
  std::vector<std::uint64_t> counts(65536, 0);
  for (const std::int16_t sample : samples) ++counts[static_cast<std::size_t>(sample + 32768)];
  if (padding) {
    std::uint64_t& padded = counts[static_cast<std::size_t>(*padding + 32768.0)];
    if (padded < samples.size()) padded = 0;
  }
  return counts;
}

double value_at(const std::vector<std::uint64_t>& counts, std::uint64_t rank) {
  assert(!counts.empty());
  std::uint64_t before = 0;
  for (std::size_t value = 0; value < counts.size(); ++value) {
    before += counts[value];
    if (before > rank) return static_cast<double>(value) - 32768.0;
  }
  return 32767.0;
}

Range percentile_range(const Scene& scene) {
  constexpr double outer = 0.001;
  const auto rank = [](double part, std::size_t count) {
    return static_cast<std::size_t>(part * static_cast<double>(count - 1));
  };
  if (const auto* samples = std::get_if<Int16Samples>(&scene.samples)) {
    const std::vector<std::uint64_t> counts = counts_of_values(*samples, scene.padding);
    const auto count = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    return {value_at(counts, rank(outer, count)), value_at(counts, rank(1 - outer, count))};
  }
  const std::vector<float> some = sorted(std::get<FloatSamples>(scene.samples), scene.padding);
  return {static_cast<double>(some[rank(outer, some.size())]),
          static_cast<double>(some[rank(1 - outer, some.size())])};
}

}  // namespace

Histogram histogram(const Scene& scene, int bins) {
  if (bins < 2) throw InvalidInput("a histogram needs at least two bins, not " + std::to_string(bins));
  check(scene);
  Range shown = percentile_range(scene);
  if (!(shown.low < shown.high)) shown = range(scene);
  if (!(shown.low < shown.high))
    throw Error(ErrorCode::Geometry,
                "all samples of this scan have the value " + rounded(shown.low) + ": choose another scan");
  Histogram result{shown.low, shown.high, std::vector<std::uint64_t>(static_cast<std::size_t>(bins), 0)};
  const double scale = (bins - 1) / (shown.high - shown.low);
  std::visit(
      [&](const auto& samples) {
        for (const auto sample : samples) {
          if (static_cast<double>(sample) == scene.padding) continue;
          const double place = std::clamp((static_cast<double>(sample) - shown.low) * scale, 0.0, bins - 1.0);
          ++result.counts[static_cast<std::size_t>(std::lround(place))];
        }
      },
      scene.samples);
  return result;
}

}  // namespace octotomy::voxel
