// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh.h"
#include "convert/finer.h"
#include "convert/tetrahedra.h"

namespace octotomy::convert {

/// TetGen keeps the surface, to the bit where `keep_boundary`. Mesh3, CGAL's Mesh_3, puts one of its own in
/// place (mesh3_tetrahedra.h) and so has no flat elements. Best: TetGen, and Mesh3 where TetGen fails or its
/// smallest dihedral angle is under `min_dihedral_deg`; of the two answers that with the larger one.
enum class Mesher { TetGen, Mesh3, Best };

struct TetOptions {
  Mesher mesher = Mesher::TetGen;
  double min_dihedral_deg = 8.0;  ///< what is aimed at, 0..30; with a kept surface it may not be reached
  double radius_edge = 1.4;       ///< TetGen's -q; 1.2 is hard, 2 is easy
  /// TetGen's -a, where `limit_volume`; must be positive. A few tetrahedra beside a kept boundary stay
  /// larger.
  double max_volume_mm3 = 0.0;
  bool limit_volume = false;
  bool keep_boundary = true;                      ///< TetGen's -Y: no new points on the surface
  std::vector<Finer> finer{};                     ///< where the surface is divided before, and elements by it
  std::chrono::milliseconds time_limit{60000};    ///< of each run, by the clock on the wall
  std::uint64_t memory_limit_bytes = 4ull << 30;  ///< of each run
  std::stop_token stop;                           ///< ends a run; then std::runtime_error says so
  /// Called now and then while a mesher runs, with the share of its time limit that is gone.
  std::function<void(double)> report{};
};

/// The smallest dihedral angle that is fit for a solver. The largest eigenvalue of an element's stiffness
/// grows as the cotangent of the angle: at 5 degrees it is cot(5) / cot(70.5) = 32 times the regular
/// element's, with which a conjugate gradient takes sqrt(32), under 6 times, as many steps; at 0.1 degrees 40
/// times. Source: Shewchuk, "What is a good linear finite element?", 2002, section 3.
constexpr double fit_dihedral_deg() {
  return 5.0;
}
/// That elements are too flat for a solver, with the angle and what made them; none where they are not.
std::optional<std::string> fault_in_shape(const Tetrahedra& tetrahedra);

/// Fills a solid by a mesher run in a process of its own, so that its crashes, loops and appetite stay there.
/// Hole points are found for cavities. Where TetGen fails, it is tried with less to ask: with quality (-pYq),
/// any tetrahedra within the same surface (-pY), any with new points on the surface allowed (-p); `method`
/// and `findings` tell. Nodes within are then moved where elements are flat (improve_tetrahedra.h). An
/// isosurface has short edges that make quality dear: brep::decimate() takes them away without
/// self-intersections. Where elements are to be finer, the surface's triangles are divided before, in their
/// planes, and elements grow inward from there. Guaranteed: all volumes positive, total volume the surface's
/// to 1e-9 of it by TetGen, to 1e-3 by Mesh_3. Throws std::invalid_argument where the mesh is not closed,
/// inside out, flat or tiny, or an option is out of range; std::runtime_error that says how the meshers
/// ended, with which switches, and what to try, and where octotomy-tetgen or octotomy-mesh3 does not lie
/// beside the running program. Source: Si, "TetGen, a Delaunay-based quality tetrahedral mesh generator", ACM
/// TOMS 41(2), 2015.
Tetrahedra tetrahedralise(const brep::Mesh& solid, const TetOptions& options = {});

/// What is wrong with tetrahedra that are to fill a surface of this volume, within a share of it: none, one
/// without volume or inside out, or the total. None where nothing is.
std::optional<std::string> fault_in_filling(const Tetrahedra& tetrahedra, double surface_mm3,
                                            double tolerance);

}  // namespace octotomy::convert
