// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The largest number of a label or of several: single precision holds every whole number up to here, and the
/// next one is what larger ones round to.
constexpr int most_number = (1 << 24) - 1;

/// Numbers for samples that lie in several labels, beyond the labels' own: see Scene::overlaps.
class LabelOverlaps {
 public:
  /// `largest_label` is the largest number that any label or sample has.
  explicit LabelOverlaps(int largest_label) : next_(largest_label + 1) {}

  /// The number of a sample that gets a label beside what its number stands for; 0 stands for none.
  int joined(int number, int label) {
    if (number == 0 || number == label) return label;
    const auto [known, is_new] = joined_.try_emplace({number, label}, 0);
    if (!is_new) return known->second;
    const auto several = overlaps_.find(number);
    std::vector<int> labels = several == overlaps_.end() ? std::vector<int>{number} : several->second;
    const auto place = std::lower_bound(labels.begin(), labels.end(), label);
    if (place != labels.end() && *place == label) return known->second = number;
    labels.insert(place, label);
    const auto [same, is_new_set] = numbers_.try_emplace(labels, next_);
    if (is_new_set) overlaps_[next_++] = labels;
    return known->second = same->second;
  }

  /// The largest number in use.
  int largest() const { return next_ - 1; }
  const std::map<int, std::vector<int>>& all() const { return overlaps_; }

 private:
  int next_;
  std::map<std::pair<int, int>, int> joined_;
  std::map<std::vector<int>, int> numbers_;
  std::map<int, std::vector<int>> overlaps_;
};

/// "500 samples lie in 1 'Mandible' and 2 'Teeth', as number 3; ...", and what that means, for the audit.
/// `counts` has the samples of each number.
std::string described(const std::map<int, std::vector<int>>& overlaps,
                      const std::map<int, std::size_t>& counts, const std::map<int, std::string>& names);

/// The scene with the lowest label where several overlap, as a file of one layer holds it.
Scene with_lowest_labels(const Scene& scene);

}  // namespace octotomy::voxel
