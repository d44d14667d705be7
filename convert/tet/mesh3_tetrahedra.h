// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "convert/tet/mesher_process.h"
#include "convert/tet/surface_sizes.h"
#include "convert/tet/tetrahedralise.h"

namespace octotomy::convert {

/// Largest relative difference between the elements' total volume and the given surface's if the mesher makes
/// its own surface: a tenth of the least uncertainty of a bone's volume in a scan's voxels.
constexpr double own_surface_volume_tolerance() {
  return 1e-3;
}

/// An answer of Mesh_3, or none.
struct Mesh3Filling {
  std::optional<Tetrahedra> tetrahedra;
  std::vector<std::string> findings;                   ///< of the failed tries, then of the answer
  voxel::ErrorCode code = voxel::ErrorCode::Geometry;  ///< of the last failure
};

/// Fills a closed surface by CGAL's Mesh_3, in a separate process. Mesh_3 makes its own surface with
/// triangles about as large as the given ones (surface_sizes.h); their middles are at most a tenth of a
/// circumradius from the given surface. Nodes move to mend slivers; surface nodes move by no more than that
/// distance. The surface moves along its normals until the volume is the given one. `surface.holes_mm` are
/// start points, some on every connected part. If a part other than thin spikes is lost, another try starts
/// there with finer elements. Closed shells that are lost whole are left out, with a finding, if their total
/// volume is below the volume's tolerance. Guaranteed of an answer: all volumes positive, total volume within
/// own_surface_volume_tolerance(). Findings say how far the surfaces lie apart. Throws as run_mesh3().
Mesh3Filling fill_by_mesh3(const MesherInput& surface, const SizeLimits& limits, double surface_mm3,
                           const TetOptions& options);

}  // namespace octotomy::convert
