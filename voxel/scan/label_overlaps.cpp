// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/label_overlaps.h"

#include <type_traits>

namespace octotomy::voxel {

std::string described(const std::map<int, std::vector<int>>& overlaps,
                      const std::map<int, std::size_t>& counts, const std::map<int, std::string>& names) {
  constexpr std::size_t most = 8;
  std::string text;
  std::size_t told = 0, more = 0;
  for (const auto& [number, labels] : overlaps) {
    const auto count = counts.find(number);
    if (count == counts.end() || count->second == 0) continue;
    if (++told > most) {
      ++more;
      continue;
    }
    text += (text.empty() ? "" : "; ") + std::to_string(count->second) +
            (count->second == 1 ? " sample lies in " : " samples lie in ");
    for (const int label : labels) {
      if (label != labels.front()) text += label == labels.back() ? " and " : ", ";
      text += std::to_string(label);
      if (const auto name = names.find(label); name != names.end()) text += " '" + name->second + "'";
    }
    text += ", as number " + std::to_string(number);
  }
  if (more > 0) text += "; and " + std::to_string(more) + " more combinations";
  return text +
         ": each segment keeps its samples; a window on numbers does not, and a label map that is written "
         "has "
         "the lowest number there";
}

Scene with_lowest_labels(const Scene& scene) {
  Scene lowest = scene;
  lowest.overlaps.clear();
  std::visit(
      [&](auto& samples) {
        using Sample = std::decay_t<decltype(samples[0])>;
        for (Sample& sample : samples)
          if (const auto found = scene.overlaps.find(static_cast<int>(sample)); found != scene.overlaps.end())
            sample = static_cast<Sample>(found->second.front());
      },
      lowest.samples);
  return lowest;
}

}  // namespace octotomy::voxel
