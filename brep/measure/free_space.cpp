// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/measure/free_space.h"

#include <array>
#include <stdexcept>
#include <utility>

#include "brep/mesh/error.h"

namespace octotomy::brep {

Solid free_space(const Solid& solid, double margin_mm) {
  if (solid.empty()) throw InvalidInput("free_space: the solid is empty");
  if (!(margin_mm > 0.0)) throw std::invalid_argument("free_space: the margin must be above 0");
  Triangles free = solid.triangles();
  for (auto& face : free.faces) std::swap(face[1], face[2]);
  const glm::dvec3 low_mm = solid.size().low_mm - margin_mm, high_mm = solid.size().high_mm + margin_mm;
  const auto first = static_cast<std::uint32_t>(free.points_mm.size());
  // Corner x + 2y + 4z.
  for (std::uint32_t corner = 0; corner < 8; ++corner)
    free.points_mm.emplace_back((corner & 1) != 0 ? high_mm.x : low_mm.x,
                                (corner & 2) != 0 ? high_mm.y : low_mm.y,
                                (corner & 4) != 0 ? high_mm.z : low_mm.z);
  constexpr std::array<std::array<std::uint32_t, 4>, 6> sides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : sides) {
    free.faces.push_back({first + a, first + b, first + c});
    free.faces.push_back({first + a, first + c, first + d});
  }
  return trusted_solid(std::move(free), proof_of_part(solid.proof()));
}

}  // namespace octotomy::brep
