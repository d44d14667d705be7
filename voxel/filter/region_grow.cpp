// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/region_grow.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "voxel/solid/combine.h"
#include "voxel/space/error.h"
#include "voxel/space/progress.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::voxel {

namespace {

void check(const GreyOctree& grey, const GrowOptions& options) {
  if (options.seeds.empty()) throw InvalidInput("a region needs at least one seed");
  if (!std::isfinite(options.tolerance) || options.tolerance < 0.0)
    throw InvalidInput("a region's tolerance must be at least zero, not " +
                       std::to_string(options.tolerance));
  const int side = grey.universe().side();
  for (const glm::ivec3& seed : options.seeds) {
    const std::string place =
        "the seed " + std::to_string(seed.x) + " " + std::to_string(seed.y) + " " + std::to_string(seed.z);
    if (glm::any(glm::lessThan(seed, glm::ivec3(0))) ||
        glm::any(glm::greaterThanEqual(seed, glm::ivec3(side))))
      throw InvalidInput(place + " is outside the universe of " + std::to_string(side) + " voxels a side");
    if (!grey.scan().contains(seed))
      throw InvalidInput(place + " lies beyond the scan or on padding, where nothing was measured");
  }
}

/// A region that grows by the mean of its samples. Rejected neighbours are stored in a list for each sample
/// value. When the mean changes, the lists of all values within the tolerance are added.
class GrowingRegion {
 public:
  GrowingRegion(const GreyOctree& grey, Neighbours neighbours)
      : grey_(grey),
        side_(grey.universe().side()),
        met_(voxel_count()),
        joined_(voxel_count()),
        waiting_(65536) {
    const int most_axes = neighbours == Neighbours::Faces ? 1 : neighbours == Neighbours::Edges ? 2 : 3;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const int axes = std::abs(x) + std::abs(y) + std::abs(z);
          if (axes > 0 && axes <= most_axes) steps_.emplace_back(x, y, z);
        }
  }

  void seed(const glm::ivec3& voxel) {
    const std::size_t at = index(voxel);
    if (joined_[at]) return;
    met_[at] = joined_[at] = true;
    count_ += 1;
    sum_ += grey_.sample(voxel);
    fresh_.push_back(voxel);
  }

  /// Adds neighbours in rounds until a round adds none.
  void grow(double tolerance, const std::stop_token& stop) {
    while (!fresh_.empty()) {
      if (stop.stop_requested()) throw Stopped("stopped while a region grew");
      meet_neighbours();
      admit(tolerance);
    }
  }

  Octree octree() const {
    return octree_of_slices(grey_.universe(), [&](int z, SliceBits& slice) {
      bool any = false;
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x)
          if (joined_[index({x, y, z})]) {
            set_row(slice, y, x, x);
            any = true;
          }
      return any;
    });
  }

 private:
  std::size_t voxel_count() const {
    return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) *
           static_cast<std::size_t>(side_);
  }
  std::size_t index(const glm::ivec3& voxel) const {
    const auto side = static_cast<std::size_t>(side_);
    return static_cast<std::size_t>(voxel.x) +
           side * (static_cast<std::size_t>(voxel.y) + side * static_cast<std::size_t>(voxel.z));
  }
  static std::size_t list_of(std::int16_t sample) { return static_cast<std::size_t>(sample + 32768); }

  void meet_neighbours() {
    for (const glm::ivec3& voxel : fresh_)
      for (const glm::ivec3& step : steps_) {
        const glm::ivec3 next = voxel + step;
        if (glm::any(glm::lessThan(next, glm::ivec3(0))) ||
            glm::any(glm::greaterThanEqual(next, glm::ivec3(side_))))
          continue;
        const std::size_t at = index(next);
        if (met_[at]) continue;
        met_[at] = true;
        if (grey_.scan().contains(next)) waiting_[list_of(grey_.sample(next))].push_back(next);
      }
    fresh_.clear();
  }

  void admit(double tolerance) {
    const double reach = tolerance * static_cast<double>(count_);
    // The mean is rounded, so the range is one value wider at each end. Each value in it is then compared
    // exactly.
    const double mean = static_cast<double>(sum_) / static_cast<double>(count_);
    const auto bound = [](double value) { return static_cast<int>(std::clamp(value, -32768.0, 32767.0)); };
    const std::int64_t count = count_, sum = sum_;
    for (int sample = bound(mean - tolerance - 1.0); sample <= bound(mean + tolerance + 1.0); ++sample) {
      std::vector<glm::ivec3>& list = waiting_[list_of(static_cast<std::int16_t>(sample))];
      if (list.empty() || static_cast<double>(std::abs(sample * count - sum)) > reach) continue;
      for (const glm::ivec3& voxel : list) joined_[index(voxel)] = true;
      count_ += static_cast<std::int64_t>(list.size());
      sum_ += sample * static_cast<std::int64_t>(list.size());
      fresh_.insert(fresh_.end(), list.begin(), list.end());
      list.clear();
    }
  }

  const GreyOctree& grey_;
  int side_;
  std::vector<glm::ivec3> steps_, fresh_;
  std::vector<bool> met_, joined_;
  std::vector<std::vector<glm::ivec3>> waiting_;
  std::int64_t count_ = 0, sum_ = 0;
};

}  // namespace

Octree grow_region(const GreyOctree& grey, const GrowOptions& options) {
  check(grey, options);
  double low = grey.sample(options.seeds.front());
  double high = low;
  for (const glm::ivec3& seed : options.seeds) {
    low = std::min(low, static_cast<double>(grey.sample(seed)));
    high = std::max(high, static_cast<double>(grey.sample(seed)));
  }
  const double tolerance = options.tolerance / grey.step();
  const Octree window = combine(grey.universe(), Window{grey, low - tolerance, high + tolerance});
  return components_at(window, options.seeds, options.neighbours);
}

Octree grow_by_running_mean(const GreyOctree& grey, const GrowOptions& options) {
  check(grey, options);
  GrowingRegion region(grey, options.neighbours);
  for (const glm::ivec3& seed : options.seeds) region.seed(seed);
  region.grow(options.tolerance / grey.step(), options.stop);
  return region.octree();
}

}  // namespace octotomy::voxel
