// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/half_width.h"

#include <algorithm>
#include <cmath>

#include "voxel/combine.h"

namespace octotomy::planner {
namespace {

constexpr double window_units = 10.0;

/// Three standard deviations of a count in cells of these edges. Exposed faces overstate a boundary of all
/// directions by 3/2, direction by direction, whatever the cells.
double count_mm3(const voxel::Measures& measures, const glm::dvec3& cell_mm) {
  const double cell_mm3 = cell_mm.x * cell_mm.y * cell_mm.z;
  const double faces = glm::dot(measures.exposed_mm2, cell_mm / cell_mm3) / 1.5;
  return 3.0 * 0.26 * cell_mm3 * std::sqrt(faces);
}

}  // namespace

HalfWidth volume_half_width(const voxel::Measures& measures, const Digitised& digitised) {
  HalfWidth found;
  found.terms.push_back({"voxels", "3 * 0.26 v sqrt(F)", count_mm3(measures, digitised.voxel_mm)});
  if (digitised.sample_mm != glm::dvec3(0.0))
    found.terms.push_back(
        {"samples", "3 * 0.26 v sqrt(F) of the scan's samples", count_mm3(measures, digitised.sample_mm)});
  if (digitised.shift_mm)
    found.terms.push_back(
        {"window", "area * shift for ten sample units", measures.area_crofton13_mm2 * *digitised.shift_mm});
  double squares = 0.0;
  for (const Doubt& doubt : found.terms) squares += doubt.half_width * doubt.half_width;
  found.value = std::sqrt(squares);
  return found;
}

std::optional<double> window_shift_mm(const voxel::Window& window) {
  const voxel::Universe& universe = window.grey.universe();
  const auto count = [&](double low) {
    voxel::Window moved = window;
    moved.low = std::min(low, moved.high);
    return static_cast<double>(voxel::combine(universe, moved).voxel_count());
  };
  const double area_mm2 = voxel::measure(voxel::combine(universe, window)).area_crofton13_mm2;
  if (!(area_mm2 > 0.0)) return std::nullopt;
  const double voxels = 0.5 * (count(window.low - window_units) - count(window.low + window_units));
  return voxels * universe.lattice().voxel_mm3() / area_mm2;
}

}  // namespace octotomy::planner
