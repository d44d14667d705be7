// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

/// A surface with integer coordinates in half voxel edges from the universe's corner: corners of voxels are
/// even, the centre of voxel (0, 0, 0) is (1, 1, 1). Counter-clockwise seen from outside in a right-handed
/// index space.
struct LatticeSurface {
  voxel::Universe universe;
  std::vector<glm::ivec3> points_half;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// Whether voxels that share only an edge belong together. Voxels that share only a corner never do: no
/// manifold surface could join them.
enum class Touching {
  Apart,    ///< neighbours share a face: the surface separates voxels that share only an edge
  Together  ///< neighbours share a face or an edge: the surface separates the outside voxels at such an edge
};

/// The cuberille (thesis 3.1.2.2) as a mesh: the exact boundary of a set of voxels, two triangles a face that
/// borders a voxel outside the set or the universe's end. Always closed, oriented and manifold: if several
/// sheets meet at an edge or corner, each sheet has its own points at the same position; `touching` decides
/// the sheets. A reader that welds points by position (STL) joins such sheets again. If two sheets run along
/// the same edge between the same two points, one bends through a point half way: its faces are four
/// triangles or more. In these coordinates, six times the volume is exactly 48 times the number of voxels;
/// the area is the number of faces. Throws voxel::Error (Resource) if there are more points or triangles than
/// 32-bit numbers can name; voxel::Stopped. Parallel; same bits on any thread count. Cost: slices of side^2 /
/// 8 bytes, the faces; memory five bytes a corner of two layers a thread. Source: Herman, Liu,
/// "Three-dimensional display of human organs from computed tomograms", CGIP 9, 1979. By duality, the sheets
/// about a corner are the loops of the marching-cubes case there.
LatticeSurface cuberille(const voxel::Octree& octree, Touching touching = Touching::Apart,
                         const voxel::Progress& progress = {});

/// In LPS millimetres, counter-clockwise seen from outside for either handedness of the universe.
brep::Triangles triangles_of(const LatticeSurface& surface);

}  // namespace octotomy::convert
