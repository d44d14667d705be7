// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// Whether the volume is positive and no dihedral angle is below `least_deg`.
bool is_fit(const TetCorners& corners_mm, double least_deg);

/// For each node, the elements with this corner, ascending.
std::vector<std::vector<std::uint32_t>> elements_about(const Tetrahedra& tetrahedra);

/// Splits edges of elements one after the other. Elements and nodes keep their numbers; new ones come after
/// them. `boundary_nodes` stay as they are.
class SideSplitter {
 public:
  /// No split makes an inverted element, or one with a dihedral angle below `least_deg` and below the
  /// smallest angle of the divided elements.
  SideSplitter(Tetrahedra& tetrahedra, double least_deg);

  /// Splits the edge between nodes a and b: divides all elements around it by a new node at `at_mm`, which
  /// need not lie on the edge. Returns false without a change if no element has the edge, or if a part would
  /// violate the constructor's condition.
  bool split(std::uint32_t a, std::uint32_t b, const glm::dvec3& at_mm);

 private:
  Tetrahedra& tetrahedra_;
  double least_deg_;
  std::vector<std::vector<std::uint32_t>> about_;
};

}  // namespace octotomy::convert
