// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/unstated_padding.h"

#include <algorithm>

#include "voxel/space/printed.h"

namespace octotomy::voxel {

namespace {

/// Air is -1000; noise of 30 to 50 HU leaves hardly a sample below this.
constexpr double below_air = -1100.0;
constexpr double gap = 100.0;
constexpr std::size_t least_padded = 64, samples_for_one_padded = 10000, padded_for_one_in_gap = 100;

}  // namespace

void take_unstated_padding(Scene& scene) {
  std::visit(
      [&](const auto& samples) {
        if (samples.empty()) return;
        const auto least = *std::min_element(samples.begin(), samples.end());
        const auto value = static_cast<double>(least);
        if (!(value < below_air)) return;
        std::size_t padded = 0, in_gap = 0, measured = 0;
        for (const auto sample : samples) {
          const double above = static_cast<double>(sample) - value;
          padded += above == 0.0;
          in_gap += above > 0.0 && above < gap;
          measured += above >= gap;
        }
        if (padded < std::max(least_padded, samples.size() / samples_for_one_padded) ||
            in_gap * padded_for_one_in_gap > padded || measured == 0)
          return;
        scene.padding = value;
        scene.audit.push_back(
            {"padding", Verdict::Warn,
             print("%zu samples (%.3g %%) hold %.9g, below air and apart from all other values, and the file "
                   "names no padding: they are taken as padding, in no window and in no interpolation",
                   padded, 100.0 * static_cast<double>(padded) / static_cast<double>(samples.size()),
                   value)});
      },
      scene.samples);
}

}  // namespace octotomy::voxel
