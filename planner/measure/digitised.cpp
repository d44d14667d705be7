// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/measure/digitised.h"

#include <algorithm>
#include <set>

#include "voxel/measure/flat_parts.h"

namespace octotomy::planner {

Digitised digitised_of(const AnswerBench& bench) {
  Digitised digitised{bench.universe.lattice().spacing_mm()};
  for (const ScanRecord& scan : bench.scans)
    digitised.sample_mm = glm::max(digitised.sample_mm, scan.lattice.spacing_mm());
  return digitised;
}

Digitised digitised_of(const AnswerBench& bench, const Object& object) {
  Digitised digitised = digitised_of(bench);
  digitised.flat_mm2 = voxel::flat_parts_mm2(object.voxel.octree);
  std::set<std::pair<std::string, double>> known;
  for (const Shown& window : object.bound.windows) {
    if (!known.emplace(window.scan, window.threshold).second) continue;
    const std::optional<double> shift_mm = window_shift_mm({window.grey, window.threshold});
    if (shift_mm) digitised.shift_mm = std::max(digitised.shift_mm.value_or(0.0), *shift_mm);
  }
  return digitised;
}

}  // namespace octotomy::planner
