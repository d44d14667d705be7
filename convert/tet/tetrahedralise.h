// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/mesh.h"
#include "convert/tet/sizing_field.h"
#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"

namespace octotomy::convert {

/// TetGen keeps the surface, to the bit with `keep_boundary`. Mesh3 (CGAL's Mesh_3, mesh3_tetrahedra.h) makes
/// a new surface and so has no flat elements. Stuffing (isosurface_stuffing.h) fills a lattice's cells: it
/// succeeds on any triangles, and loses parts thinner than a cell. Best runs TetGen. If TetGen fails or
/// leaves a dihedral angle under `min_dihedral_deg`, it also runs Mesh3 and returns the result whose smallest
/// angle is larger. If neither reaches fit_dihedral_deg(), it also runs Stuffing. If the surface has more
/// than five triangles per millisecond of the time limit, it runs Stuffing first, and the others only if
/// Stuffing fails.
enum class Mesher { TetGen, Mesh3, Stuffing, Best };

struct TetOptions {
  Mesher mesher = Mesher::TetGen;
  double min_dihedral_deg = 8.0;  ///< goal, 0..30; a kept surface may make it unreachable
  double radius_edge = 1.4;       ///< TetGen's -q, 1 or more; 1.2 is hard, 2 is easy
  /// Largest element, above 0. Larger triangles of a surface that TetGen keeps are divided in their planes. A
  /// finding counts elements that are still larger.
  std::optional<double> max_volume_mm3{};
  bool keep_boundary = true;                    ///< TetGen's -Y: keeps the surface's triangles
  std::vector<Refinement> finer{};              ///< divides the surface first; elements follow its triangles
  std::chrono::milliseconds time_limit{60000};  ///< processor time of each run
  std::uint64_t memory_limit_bytes = 4ull << 30;  ///< of each run
  voxel::Progress progress{};                     ///< reports the share of a run's time limit that is used up
};

/// The smallest dihedral angle that is fit for a solver. The largest eigenvalue of an element's stiffness
/// grows as the cotangent of the angle: at 5 degrees it is cot(5) / cot(70.5) = 32 times the regular
/// element's, so a conjugate gradient solver takes sqrt(32), less than 6, times as many steps; at 0.1 degrees
/// 40 times. Source: Shewchuk, "What is a good linear finite element?", 2002, section 3.
constexpr double fit_dihedral_deg() {
  return 5.0;
}
/// Why elements are too flat for a solver, with the angle and the mesher; none if they are fit.
std::optional<std::string> fault_in_shape(const Tetrahedra& tetrahedra);

/// Fills a solid with tetrahedra. The mesher runs in a separate process, so its crashes, loops and memory
/// stay there.
///
/// If TetGen fails it runs again with fewer demands: with quality (-pYq), without (-pY), with new points on
/// the surface (-p), and without the largest volume last; `method` and `findings` report which. Nodes inside
/// then move to improve flat elements (improve_tetrahedra.h). Short edges of an isosurface make quality
/// expensive: run brep::decimate() first. Refinements divide the surface's triangles in their planes, and
/// elements grow inward from there. Stuffing's cells are as large as the triangles' mean side, or larger if
/// these cells would make more than two million elements; findings report how far its surface lies from the
/// given one, and where refinements had no effect.
///
/// Guaranteed: all volumes positive; the total volume differs from the surface's by a share of at most 1e-9
/// for TetGen, 1e-3 for Mesh_3, 5e-2 for Stuffing. Throws voxel::Error: Geometry if the mesh is open, inside
/// out, flat or tiny, or the meshers fail on it; Resource if a limit of time or memory ends the last of them,
/// or a mesher is not installed beside the running program. The message names the switches tried and the next
/// remedy. Throws std::invalid_argument if an option is out of range, or the largest volume requires more
/// than 2e7 elements; voxel::Stopped. Source: Si, "TetGen, a Delaunay-based quality tetrahedral mesh
/// generator", ACM TOMS 41(2), 2015.
Tetrahedra tetrahedralise(const brep::Mesh& solid, const TetOptions& options = {});

/// Describes the fault of tetrahedra that should fill a surface of this volume within a relative tolerance:
/// no tetrahedra, one without positive volume, or another total. Returns none if there is no fault.
std::optional<std::string> fault_in_filling(const Tetrahedra& tetrahedra, double surface_mm3,
                                            double tolerance);

}  // namespace octotomy::convert
