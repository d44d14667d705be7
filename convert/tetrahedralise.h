// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/mesh.h"

namespace octotomy::convert {

/// Tetrahedra in LPS millimetres; nodes 0, 1, 2 of each are counter-clockwise seen from node 3 being behind
/// them, so that all volumes are positive (Abaqus's order).
struct Tetrahedra {
  std::vector<glm::dvec3> nodes_mm;
  std::vector<std::array<std::uint32_t, 4>> tets;
  std::vector<std::uint32_t> boundary_nodes;  ///< nodes on the surface, ascending
};

struct TetQuality {
  double volume_mm3 = 0.0;
  double min_dihedral_deg = 0.0;
  double max_dihedral_deg = 0.0;
  double max_radius_edge = 0.0;  ///< circumradius by shortest edge
};
TetQuality quality(const Tetrahedra& tetrahedra);

struct TetOptions {
  double radius_edge = 1.4;     ///< TetGen's -q; 1.2 is hard, 2 is easy
  double max_volume_mm3 = 0.0;  ///< TetGen's -a; must be positive where `limit_volume`
  bool limit_volume = false;
  bool keep_boundary = true;            ///< TetGen's -Y: no new points on the surface
  std::chrono::seconds time_limit{60};  ///< of the child process
  std::uint64_t memory_limit_bytes = 4ull << 30;
};

/// Fills a solid by TetGen, run in a child process so that its crashes, loops and appetite stay there. Hole
/// points are found for cavities. Throws std::invalid_argument where the mesh is not closed, flat or tiny,
/// and std::runtime_error that says how TetGen ended, with which switches, and what to try.
Tetrahedra tetrahedralise(const brep::Mesh& solid, const TetOptions& options = {});

}  // namespace octotomy::convert
