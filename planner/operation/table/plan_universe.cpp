// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/plan_universe.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "planner/operation/table/number_format.h"
#include "voxel/space/error.h"
#include "voxel/space/memory_need.h"

namespace octotomy::planner {
namespace {

double longest_side_mm(const voxel::Box& box) {
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  return std::max({extent_mm.x, extent_mm.y, extent_mm.z});
}

voxel::Universe universe_about(const voxel::Lattice& scan, std::optional<double> voxel_mm, bool by_cells) {
  const voxel::Box box = voxel::bounds(scan);
  const glm::dvec3 spacing_mm = scan.spacing_mm();
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  constexpr double most_a_side = 512.0;
  const double finest_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  const double longest_mm = std::max({extent_mm.x, extent_mm.y, extent_mm.z});
  const double edge_mm = voxel_mm.value_or(std::max(finest_mm, longest_mm / most_a_side));
  voxel::Universe universe = voxel::universe_around(box, edge_mm);
  if (edge_mm < 0.5 * finest_mm) {
    const glm::dvec3 voxels = glm::ceil(extent_mm / edge_mm);
    constexpr double most = 1e18;
    voxel::need_memory("voxels of " + plain(edge_mm) + " mm",
                       static_cast<std::uint64_t>(std::min(most, voxels.x * voxels.y * voxels.z)),
                       sizeof(std::int16_t), "in the scan's box they");
  }
  // Around an odd number of samples, a universe is shifted by half a voxel, so that resampling would blur
  // samples without need. The universe is moved so that a voxel's centre lies on the first sample, if it then
  // still contains the scan.
  glm::dvec3 first = universe.lattice().voxel(scan.lps_mm(glm::dvec3(0.0)));
  // The offset at which the border of the first cell coincides with a border of voxels.
  if (by_cells) first += 0.5 - 0.5 * spacing_mm / edge_mm;
  const double spare_voxels = 0.5 * universe.side();
  for (int axis = 0; axis < 3; ++axis) {
    const double shift = first[axis] - std::floor(first[axis] + 0.5);
    if (0.5 * extent_mm[axis] / edge_mm + std::abs(shift) <= spare_voxels)
      universe.lps_from_voxel[3][axis] += shift * edge_mm;
  }
  return universe;
}

}  // namespace

voxel::Universe universe_of(const voxel::Lattice& scan, std::optional<double> voxel_mm) {
  return universe_about(scan, voxel_mm, false);
}

voxel::Universe universe_of(const voxel::Scene& scan, std::optional<double> voxel_mm, bool are_labels) {
  return universe_about(scan.lattice, voxel_mm, are_labels || scan.meaning == voxel::Meaning::Label);
}

voxel::Universe universe_of(const std::vector<voxel::Box>& meshes, std::optional<double> voxel_mm) {
  constexpr double mesh_voxels = 128.0, most_a_side = 512.0;
  if (meshes.empty()) throw std::invalid_argument("universe_of: there is no mesh");
  voxel::Box all = meshes.front();
  double mesh_mm = 0.0;
  for (const voxel::Box& box : meshes) {
    all = {glm::min(all.low_mm, box.low_mm), glm::max(all.high_mm, box.high_mm)};
    mesh_mm = std::max(mesh_mm, longest_side_mm(box));
  }
  if (!(mesh_mm > 0.0)) throw voxel::InvalidInput("universe_of: the meshes have no extent");
  all = {all.low_mm - 0.5 * mesh_mm, all.high_mm + 0.5 * mesh_mm};
  return voxel::universe_around(
      all, voxel_mm.value_or(std::max(mesh_mm / mesh_voxels, longest_side_mm(all) / most_a_side)));
}

}  // namespace octotomy::planner
