// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/fill_cavities.h"

#include <glm/glm.hpp>
#include <stdexcept>
#include <vector>

#include "brep/mesh/components.h"
#include "brep/mesh/disjoint_sets.h"
#include "brep/mesh/triangles.h"

namespace octotomy::convert {

FilledCavities fill_cavities(const brep::Solid& solid, double smaller_than_mm3) {
  if (!(smaller_than_mm3 > 0.0)) throw std::invalid_argument("fill_cavities: the volume must be positive");
  const brep::Triangles& surface = solid.triangles();
  brep::DisjointSets shells(surface.points_mm.size());
  for (const auto& [a, b, c] : surface.faces) {
    shells.join(a, b);
    shells.join(a, c);
  }
  // Indexed by the shell's representative point. Volumes are computed about that point to keep precision.
  std::vector<double> volume_mm3(surface.points_mm.size(), 0.0);
  for (const auto& [a, b, c] : surface.faces) {
    const std::uint32_t shell = shells.set_of(a);
    const auto& p = surface.points_mm;
    volume_mm3[shell] += glm::dot(glm::cross(p[b] - p[a], p[c] - p[a]), p[a] - p[shell]) / 6.0;
  }
  FilledCavities filled;
  for (const double own_mm3 : volume_mm3)
    if (own_mm3 < 0.0 && -own_mm3 < smaller_than_mm3) {
      ++filled.cavities;
      filled.volume_mm3 -= own_mm3;
    }
  std::vector<std::uint32_t> kept;
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f) {
    const double own_mm3 = volume_mm3[shells.set_of(surface.faces[f][0])];
    if (own_mm3 >= 0.0 || -own_mm3 >= smaller_than_mm3) kept.push_back(f);
  }
  filled.solid = filled.cavities == 0
                     ? solid
                     : brep::trusted_solid(brep::part_of(solid, kept), brep::proof_of_part(solid.proof()));
  return filled;
}

}  // namespace octotomy::convert
