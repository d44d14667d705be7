// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The largest allowed number of a label or an overlap. Single precision represents every integer up to this
/// one; 2^24 is excluded because 2^24 + 1 is rounded to it.
constexpr int most_number = (1 << 24) - 1;

/// Assigns a number above all labels to each set of labels that overlap in a sample: see Scene::overlaps.
class LabelOverlaps {
 public:
  /// `largest_label` is the largest number that any label or sample has.
  explicit LabelOverlaps(int largest_label) : next_(largest_label + 1) {}

  /// The new number of a sample with the number `number` after a label was added to the sample; 0 means no
  /// label.
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

/// Text for the audit: "500 samples lie in 1 'Mandible' and 2 'Teeth', as number 3; ...", followed by the
/// consequence for windows and files. `counts` has the number of samples of each number.
std::string described(const std::map<int, std::vector<int>>& overlaps,
                      const std::map<int, std::size_t>& counts, const std::map<int, std::string>& names);

/// A copy of the scene in which samples with several labels have only the lowest one, for files with one
/// layer.
Scene with_lowest_labels(const Scene& scene);

}  // namespace octotomy::voxel
