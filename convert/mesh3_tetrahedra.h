// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "convert/mesher_process.h"
#include "convert/surface_sizes.h"
#include "convert/tetrahedralise.h"

namespace octotomy::convert {

/// How far a mesher's total volume may be from the surface's, of it, where the mesher puts a surface of its
/// own in place: a tenth of what the voxels of a scan leave unknown of a bone's volume at best.
constexpr double own_surface_volume_tolerance() {
  return 1e-3;
}

/// Fills a closed surface by CGAL's Mesh_3, run in a process of its own, which puts a surface of its own in
/// place: triangles as large as the given ones are about there (surface_sizes.h), within a tenth of their
/// circumradius. Slivers are mended by moving nodes, those of the surface by no more than that; the volume is
/// made the given one's by moving the surface along its normals. Points of `surface.holes_mm` are where it
/// starts, some on every connected part. Where more of the surface is lost than thin spikes, it is tried
/// again with finer elements about there, and from there. Guaranteed of an answer: all volumes positive,
/// total volume within own_surface_volume_tolerance(). Its findings say how far the surfaces lie apart. An
/// answer without failure has tetrahedra.
struct Mesh3Filling {
  std::optional<Tetrahedra> tetrahedra;
  std::vector<std::string> findings;  ///< tries that came to nothing, then what is to be said of the answer
};
Mesh3Filling fill_by_mesh3(const MesherInput& surface, const SizeLimits& limits, double surface_mm3,
                           const TetOptions& options);

}  // namespace octotomy::convert
