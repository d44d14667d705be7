// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <glm/glm.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh.h"

namespace octotomy::convert {

/// Tetrahedra in LPS millimetres. Corners 0, 1, 2 of each run counter-clockwise seen from corner 3's side, so
/// that (n1 - n0) x (n2 - n0) . (n3 - n0) is positive: the order of Abaqus and VTK.
struct Tetrahedra {
  std::vector<glm::dvec3> nodes_mm;
  std::vector<std::array<std::uint32_t, 4>> tets;
  std::vector<std::uint32_t> boundary_nodes;  ///< nodes on the surface, ascending
  std::vector<std::uint32_t> region_of_tet;   ///< from 0; empty: all are one region
  std::string method;                         ///< what gave it: "TetGen -pYq1.4" or "octree"
  std::vector<std::string> findings;          ///< switches tried before and how they ended
};

struct TetQuality {
  double volume_mm3 = 0.0;
  double min_volume_mm3 = 0.0;
  double min_dihedral_deg = 0.0;  ///< 70.53 for the regular tetrahedron, 0 for a flat one
  double max_dihedral_deg = 0.0;
  double max_radius_edge = 0.0;  ///< circumradius by shortest edge; 0.612 for the regular tetrahedron
};
/// Volumes are summed in the tetrahedra's order. Throws std::invalid_argument where there are none.
TetQuality quality(const Tetrahedra& tetrahedra);

/// Nodes of the faces that only one tetrahedron has, ascending. Cost: n log n.
std::vector<std::uint32_t> boundary_nodes(const std::vector<std::array<std::uint32_t, 4>>& tets);

struct TetOptions {
  double radius_edge = 1.4;  ///< TetGen's -q; 1.2 is hard, 2 is easy
  /// TetGen's -a, where `limit_volume`; must be positive. A few tetrahedra beside a kept boundary stay
  /// larger.
  double max_volume_mm3 = 0.0;
  bool limit_volume = false;
  bool keep_boundary = true;                      ///< TetGen's -Y: no new points on the surface
  std::chrono::milliseconds time_limit{60000};    ///< of each run of TetGen, by the clock on the wall
  std::uint64_t memory_limit_bytes = 4ull << 30;  ///< of each run
  std::stop_token stop;                           ///< ends a run; then std::runtime_error says so
};

/// Fills a solid by TetGen, run in a process of its own so that its crashes, loops and appetite stay there.
/// Hole points are found for cavities. Where it fails, it is tried with less to ask: with quality (-pYq), any
/// tetrahedra within the same surface (-pY), any with new points on the surface allowed (-p); `method` and
/// `findings` tell. An isosurface has short edges that make quality dear: brep::decimate() takes them away
/// without self-intersections. Guaranteed: all volumes positive, total volume the surface's to 1e-9 of it.
/// Throws std::invalid_argument where the mesh is not closed, inside out, flat or tiny, or an option is out
/// of range; std::runtime_error that says how TetGen ended, with which switches, and what to try, and where
/// octotomy-tetgen does not lie beside the running program.
/// Source: Si, "TetGen, a Delaunay-based quality tetrahedral mesh generator", ACM TOMS 41(2), 2015.
Tetrahedra tetrahedralise(const brep::Mesh& solid, const TetOptions& options = {});

}  // namespace octotomy::convert
