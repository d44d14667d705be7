// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/tet/midline.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "convert/tet/element_faces.h"
#include "voxel/space/error.h"

namespace octotomy::convert {

std::vector<std::uint32_t> midline_nodes(const Tetrahedra& tetrahedra, const glm::dvec3& point_mm,
                                         const glm::dvec3& normal) {
  if (!(glm::length(normal) > 0.0)) throw voxel::InvalidInput("midline: the plane's normal has no direction");
  const auto off = [&](std::uint32_t node) { return glm::dot(normal, tetrahedra.nodes_mm[node] - point_mm); };
  std::vector<std::uint32_t> nodes;
  for (const ElementFace& face : surface_faces(tetrahedra)) {
    const auto corners = corners_of(tetrahedra, face);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(corners.at(i), corners.at((i + 1) % 3));
      const double off_low = off(low), off_high = off(high);
      if (off_low * off_high > 0.0) continue;
      // If the side lies in the plane, both its ends are added.
      if (std::abs(off_low) <= std::abs(off_high)) nodes.push_back(low);
      if (std::abs(off_high) < std::abs(off_low) || off_high == 0.0) nodes.push_back(high);
    }
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace octotomy::convert
