// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/bridges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "verify/necks.h"

namespace octotomy::verify {
namespace {

/// The neck by which one of the choices leaves a part open; the part's points are those of the object.
std::optional<WorstPlace> bridge_of(const std::vector<glm::dvec3>& part_mm, bool in_voxels, double volume_mm3,
                                    const std::vector<PartChoice>& choices) {
  for (const PartChoice& choice : choices) {
    std::vector<glm::dvec3> chosen_mm;
    for (const glm::dvec3& p_mm : part_mm)
      chosen_mm.emplace_back(choice.chosen_from_made * glm::dvec4(p_mm, 1.0));
    if (const std::optional<glm::dvec3> neck = choice.necks->neck_mm(chosen_mm))
      return WorstPlace{glm::dvec3(glm::inverse(choice.chosen_from_made) * glm::dvec4(*neck, 1.0)),
                        std::cbrt(volume_mm3),
                        in_voxels ? "the voxel kernel keeps a part beyond a thin neck"
                                  : "the mesh kernel keeps a part beyond a thin neck",
                        volume_mm3};
  }
  return std::nullopt;
}

}  // namespace

bool before(const glm::ivec3& a, const glm::ivec3& b) {
  return a.z != b.z ? a.z < b.z : a.y != b.y ? a.y < b.y : a.x < b.x;
}

std::vector<std::vector<std::size_t>> groups_of(const std::vector<glm::ivec3>& voxels) {
  const auto index_of = [&](const glm::ivec3& at) {
    const auto found = std::lower_bound(voxels.begin(), voxels.end(), at, before);
    return found != voxels.end() && *found == at ? static_cast<std::size_t>(found - voxels.begin())
                                                 : voxels.size();
  };
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::uint8_t> seen(voxels.size(), 0);
  for (std::size_t first = 0; first < voxels.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = 1;
    std::vector<std::size_t> group{first};
    for (std::size_t next = 0; next < group.size(); ++next)
      for (int neighbour = 0; neighbour < 27; ++neighbour) {
        const glm::ivec3 by(neighbour % 3 - 1, neighbour / 3 % 3 - 1, neighbour / 9 - 1);
        const std::size_t i = index_of(voxels[group[next]] + by);
        if (i == voxels.size() || seen[i]) continue;
        seen[i] = 1;
        group.push_back(i);
      }
    groups.push_back(std::move(group));
  }
  return groups;
}

// The answers that are judged hang on by necks of their own, whatever was chosen on the way.
Bridges::Bridges(const voxel::Octree& octree, const voxel::Octree& digitised, const Witness& witness)
    : octree_(octree) {
  if (witness.choices().empty()) return;
  for (const PartChoice& choice : witness.choices())
    if (choice.necks) choices_.push_back(choice);
  choices_.push_back({std::make_shared<const Necks>(octree, digitised, witness)});
}

std::vector<WorstPlace> Bridges::take_from(std::vector<glm::ivec3>& voxels) const {
  if (choices_.empty()) return {};
  const voxel::Lattice lattice = octree_.universe().lattice();
  std::vector<WorstPlace> bridges;
  std::vector<glm::ivec3> rest;
  for (const bool in_voxels : {true, false}) {
    std::vector<glm::ivec3> side;
    std::copy_if(voxels.begin(), voxels.end(), std::back_inserter(side),
                 [&](const glm::ivec3& at) { return octree_.contains(at) == in_voxels; });
    for (const std::vector<std::size_t>& part : groups_of(side)) {
      std::vector<glm::dvec3> part_mm;
      for (const std::size_t i : part) part_mm.push_back(lattice.lps_mm(glm::dvec3(side[i])));
      const double volume_mm3 = static_cast<double>(part.size()) * lattice.voxel_mm3();
      if (const std::optional<WorstPlace> bridge = bridge_of(part_mm, in_voxels, volume_mm3, choices_))
        bridges.push_back(*bridge);
      else
        for (const std::size_t i : part) rest.push_back(side[i]);
    }
  }
  voxels = std::move(rest);
  return bridges;
}

}  // namespace octotomy::verify
