// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <utility>
#include <vector>

namespace octotomy::convert {

/// Tetrahedra in LPS millimetres. Corners 0, 1, 2 of each run counter-clockwise seen from corner 3's side, so
/// that (n1 - n0) x (n2 - n0) . (n3 - n0) is positive: the order of Abaqus and VTK.
struct Tetrahedra {
  std::vector<glm::dvec3> nodes_mm;
  std::vector<std::array<std::uint32_t, 4>> tets;
  /// Nodes in the middle of the sides of second-order elements, in the order of `sides_of_tet`: that of
  /// Abaqus, FEBio and VTK. Empty: elements are linear.
  std::vector<std::array<std::uint32_t, 6>> mid_nodes;
  std::vector<std::uint32_t> boundary_nodes;  ///< nodes on the surface, ascending
  std::vector<std::uint32_t> region_of_tet;   ///< from 0; empty: all are one region
  std::string method;                         ///< "TetGen -pYq1.4", "octree", ...
  std::vector<std::string> findings;          ///< failed tries, and doubts
};

/// The ends of a tetrahedron's sides, by its corners.
inline constexpr std::array<std::pair<std::uint8_t, std::uint8_t>, 6> sides_of_tet{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// The region of an element; 0 if all are one region.
std::uint32_t region_of(const Tetrahedra& tetrahedra, std::size_t tet);

/// The corners of an element.
using TetCorners = std::array<glm::dvec3, 4>;
TetCorners corners_mm(const Tetrahedra& tetrahedra, std::size_t tet);
/// Six times the signed volume; positive in the order that Tetrahedra documents.
double six_volumes(const TetCorners& corners_mm);

struct TetQuality {
  double volume_mm3 = 0.0;
  double min_volume_mm3 = 0.0;
  double min_dihedral_deg = 0.0;  ///< 70.53 for the regular tetrahedron, 0 for a flat one
  double max_dihedral_deg = 0.0;
  double max_radius_edge = 0.0;  ///< circumradius divided by shortest edge; 0.612 for the regular tetrahedron
  /// The number of elements by smallest dihedral angle: below each of `dihedral_steps_deg` but not below the
  /// one before; the last entry counts the rest.
  std::array<std::size_t, 6> by_dihedral{};
};
inline constexpr std::array<double, 5> dihedral_steps_deg{5.0, 10.0, 20.0, 30.0, 45.0};

/// Sums volumes in the tetrahedra's order. Throws std::invalid_argument if there are none.
TetQuality quality(const Tetrahedra& tetrahedra);

/// Nodes of faces that belong to only one tetrahedron, ascending. Cost: n log n.
std::vector<std::uint32_t> boundary_nodes(const std::vector<std::array<std::uint32_t, 4>>& tets);

}  // namespace octotomy::convert
