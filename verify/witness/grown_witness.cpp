// SPDX-License-Identifier: AGPL-3.0-or-later
// Two floods over the scan's samples: one through those that surely belong, one through those that may. A
// sample of the first is certainly inside, one that the second does not reach is certainly outside.
#include "verify/witness/grown_witness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>

#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

constexpr std::uint8_t may_belong = 1, surely_belongs = 2;
/// How far a point may lie from a sample and still be it, in samples: the rounding of coordinates.
constexpr double same_place = 1e-6;

/// The samples of a scan, with what of them was reached.
class Grown {
 public:
  Grown(const voxel::Scene& scan, const GrownFrom& from)
      : dims_(scan.lattice.dims), voxel_from_lps_(glm::inverse(scan.lattice.lps_from_voxel)) {
    if (from.seeds_mm.empty()) throw voxel::InvalidInput("nothing grows without a seed");
    if (from.neighbours != 6 && from.neighbours != 18 && from.neighbours != 26)
      throw voxel::InvalidInput("neighbours are 6, 18 or 26");
    std::vector<glm::ivec3> seeds;
    for (const glm::dvec3& p_mm : from.seeds_mm) {
      const glm::ivec3 seed(glm::floor(place_of(p_mm) + 0.5));
      if (!has(seed)) throw voxel::InvalidInput("a seed lies beyond the scan");
      seeds.push_back(seed);
    }
    std::visit([&](const auto& samples) { grow(samples, scan, from, seeds); }, scan.samples);
  }

  AllowedSides allowed(const glm::dvec3& p_mm) const {
    const glm::dvec3 place = place_of(p_mm);
    const glm::dvec3 nearest = glm::floor(place + 0.5);
    if (glm::any(glm::greaterThan(glm::abs(place - glm::dvec3(dims_ - 1) * 0.5),
                                  glm::dvec3(dims_) * 0.5 + same_place)))
      return certainly_out;
    // Of the samples about the point: along an axis on which it lies at a sample, that one alone.
    glm::ivec3 low(glm::floor(place)), high = low + 1;
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(place[axis] - nearest[axis]) <= same_place)
        low[axis] = high[axis] = static_cast<int>(nearest[axis]);
    bool all_in = true, all_out = true;
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
          const std::uint8_t state = has({x, y, z}) ? reached_[index({x, y, z})] : std::uint8_t{0};
          all_in = all_in && (state & surely_belongs) != 0;
          all_out = all_out && state == 0;
        }
    return all_in ? certainly_in : all_out ? certainly_out : either_side;
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
    reached_.assign(samples.size(), 0);
    flood(seeds, from.neighbours, may_belong, [&](std::size_t i) { return belongs(i, from.rounding); });
    flood(seeds, from.neighbours, surely_belongs, [&](std::size_t i) { return belongs(i, -from.rounding); });
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
