// SPDX-License-Identifier: AGPL-3.0-or-later
// Two floods over the scan's samples: one through the samples that surely belong to the region, one through
// the samples that may belong to it. A sample that the first one reaches is certainly inside. A sample that
// the second one does not reach is certainly outside.
#include "verify/witness/grown_witness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>

#include "verify/witness/sample_sides.h"
#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

constexpr std::uint8_t may_belong = 1, surely_belongs = 2;

/// The samples of a scan, each with two marks: it surely belongs to the region, and it may belong to it.
class Grown {
 public:
  Grown(const voxel::Scene& scan, const GrownFrom& from)
      : dims_(scan.lattice.dims), voxel_from_lps_(glm::inverse(scan.lattice.lps_from_voxel)) {
    if (from.seeds_mm.empty()) throw voxel::InvalidInput("growing a region needs at least one seed");
    if (from.neighbours != 6 && from.neighbours != 18 && from.neighbours != 26)
      throw voxel::InvalidInput("the number of neighbours must be 6, 18 or 26");
    std::vector<glm::ivec3> seeds;
    for (const glm::dvec3& p_mm : from.seeds_mm) {
      const glm::ivec3 seed(glm::floor(place_of(p_mm) + 0.5));
      if (!has(seed)) throw voxel::InvalidInput("a seed of the region lies outside the scan");
      seeds.push_back(seed);
    }
    std::visit([&](const auto& samples) { grow(samples, scan, from, seeds); }, scan.samples);
  }

  AllowedSides allowed(const glm::dvec3& p_mm) const {
    return sides_by_samples(place_of(p_mm), dims_, [&](const glm::ivec3& sample) {
      const std::uint8_t state = has(sample) ? reached_[index(sample)] : std::uint8_t{0};
      return SampleSide{(state & surely_belongs) != 0, state == 0};
    });
  }

 private:
  glm::dvec3 place_of(const glm::dvec3& p_mm) const {
    return glm::dvec3(voxel_from_lps_ * glm::dvec4(p_mm, 1.0));
  }
  bool has(const glm::ivec3& sample) const {
    return glm::all(glm::greaterThanEqual(sample, glm::ivec3(0))) && glm::all(glm::lessThan(sample, dims_));
  }
  std::size_t index(const glm::ivec3& sample) const {
    return static_cast<std::size_t>(sample.x) +
           static_cast<std::size_t>(dims_.x) *
               (static_cast<std::size_t>(sample.y) +
                static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(sample.z));
  }

  template <typename Samples>
  void grow(const Samples& samples, const voxel::Scene& scan, const GrownFrom& from,
            const std::vector<glm::ivec3>& seeds) {
    reached_.assign(samples.size(), 0);
    if (from.tolerance && from.mean_of_steps) return grow_by_mean(samples, scan, from, seeds);
    double low = from.low, high = from.high;
    if (from.tolerance) {
      low = std::numeric_limits<double>::infinity();
      high = -low;
      for (const glm::ivec3& seed : seeds) {
        const auto sample = static_cast<double>(samples[index(seed)]);
        low = std::min(low, sample - *from.tolerance);
        high = std::max(high, sample + *from.tolerance);
      }
    }
    const auto belongs = [&](std::size_t i, double by) {
      const auto sample = static_cast<double>(samples[i]);
      if (scan.padding && sample <= static_cast<double>(*scan.padding)) return false;
      return sample >= low - by && sample <= high + by;
    };
    flood(seeds, from.neighbours, may_belong, [&](std::size_t i) { return belongs(i, from.rounding); });
    flood(seeds, from.neighbours, surely_belongs, [&](std::size_t i) { return belongs(i, -from.rounding); });
  }

  /// Grows in rounds. Each round compares all neighbours of the region with its mean, also those that an
  /// earlier round refused.
  template <typename Samples>
  void grow_by_mean(const Samples& samples, const voxel::Scene& scan, const GrownFrom& from,
                    const std::vector<glm::ivec3>& seeds) {
    const double step = *from.mean_of_steps;
    const auto steps_at = [&](std::size_t i) {
      return std::floor(static_cast<double>(samples[i]) / step + 0.5);
    };
    const auto is_measured = [&](std::size_t i) {
      const auto sample = static_cast<double>(samples[i]);
      return !std::isnan(sample) && !(scan.padding && sample <= static_cast<double>(*scan.padding));
    };
    const int most_axes = from.neighbours == 6 ? 1 : from.neighbours == 18 ? 2 : 3;
    constexpr std::uint8_t is_met = 4;
    double count = 0.0, sum = 0.0;  // whole numbers below 2^53
    std::vector<glm::ivec3> joined, refused;
    const auto join = [&](const glm::ivec3& sample) {
      const std::size_t i = index(sample);
      if ((reached_[i] & surely_belongs) != 0) return;
      reached_[i] = is_met | may_belong | surely_belongs;
      count += 1.0;
      sum += steps_at(i);
      joined.push_back(sample);
    };
    for (const glm::ivec3& seed : seeds) join(seed);
    while (!joined.empty()) {
      for (const glm::ivec3& at : std::exchange(joined, {}))
        for (int z = -1; z <= 1; ++z)
          for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
              const glm::ivec3 sample = at + glm::ivec3(x, y, z);
              if (std::abs(x) + std::abs(y) + std::abs(z) > most_axes || !has(sample)) continue;
              const std::size_t i = index(sample);
              if (reached_[i] != 0 || !is_measured(i)) continue;
              reached_[i] = is_met;
              refused.push_back(sample);
            }
      const double count_before = count, sum_before = sum;
      std::vector<glm::ivec3> still;
      for (const glm::ivec3& sample : std::exchange(refused, {}))
        if (std::abs(steps_at(index(sample)) * count_before - sum_before) <=
            *from.tolerance / step * count_before)
          join(sample);
        else
          still.push_back(sample);
      refused = std::move(still);
    }
    for (std::uint8_t& state : reached_)
      state = static_cast<std::uint8_t>(state & (may_belong | surely_belongs));
  }

  template <typename Belongs>
  void flood(const std::vector<glm::ivec3>& seeds, int neighbours, std::uint8_t mark,
             const Belongs& belongs) {
    const int most_axes = neighbours == 6 ? 1 : neighbours == 18 ? 2 : 3;
    std::vector<glm::ivec3> waiting;
    const auto reach = [&](const glm::ivec3& sample) {
      if (!has(sample)) return;
      const std::size_t i = index(sample);
      if ((reached_[i] & mark) != 0 || !belongs(i)) return;
      reached_[i] = static_cast<std::uint8_t>(reached_[i] | mark);
      waiting.push_back(sample);
    };
    for (const glm::ivec3& seed : seeds) reach(seed);
    while (!waiting.empty()) {
      const glm::ivec3 at = waiting.back();
      waiting.pop_back();
      for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
          for (int x = -1; x <= 1; ++x)
            if (std::abs(x) + std::abs(y) + std::abs(z) <= most_axes) reach(at + glm::ivec3(x, y, z));
    }
  }

  glm::ivec3 dims_;
  glm::dmat4 voxel_from_lps_;
  std::vector<std::uint8_t> reached_;
};

}  // namespace

Witness witness_of_grown(const voxel::Scene& scan, const GrownFrom& from) {
  const auto grown = std::make_shared<const Grown>(scan, from);
  return [grown](const glm::dvec3& p_mm, double) {
    const AllowedSides allowed = grown->allowed(p_mm);
    return Reading{allowed, allowed, 0};
  };
}

}  // namespace octotomy::verify
