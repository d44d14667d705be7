// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/interval/sample_density.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace octotomy::verify {
namespace {

double median_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

SampleDensity densest(std::vector<float>& values) {
  std::sort(values.begin(), values.end());
  const std::size_t quarter = values.size() / 4;
  std::size_t narrowest = 0;
  for (std::size_t i = 0; i + quarter < values.size(); ++i)
    if (values[i + quarter] - values[i] < values[narrowest + quarter] - values[narrowest]) narrowest = i;
  // A quarter of all normal values lies within 0.319 deviations of the mean. Among many quarters the
  // narrowest one is narrower than that, hence the factor 1.5.
  return {static_cast<double>(values[narrowest + quarter / 2]),
          1.5 / 0.637 * static_cast<double>(values[narrowest + quarter] - values[narrowest])};
}

SampleDensity refined(const std::vector<float>& values, SampleDensity level) {
  for (int round = 0; round < 4; ++round) {
    const double within = std::max(3.5 * level.noise, 1.0);
    std::vector<float> about, off;
    for (const float value : values)
      if (std::abs(static_cast<double>(value) - level.value) <= within) about.push_back(value);
    if (about.empty()) return level;
    level.value = median_of(about);
    for (const float value : about) off.push_back(std::abs(value - static_cast<float>(level.value)));
    level.noise = std::min(level.noise, 1.4826 * median_of(off));
  }
  return level;
}

double nearest_mode(const std::vector<float>& values, SampleDensity level) {
  for (int round = 0; round < 8; ++round) {
    std::vector<float> about;
    for (const float value : values)
      if (std::abs(static_cast<double>(value) - level.value) <= std::max(1.5 * level.noise, 1.0))
        about.push_back(value);
    if (about.empty()) break;
    level.value = median_of(about);
  }
  return level.value;
}

}  // namespace octotomy::verify
