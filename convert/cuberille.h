// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/triangles.h"
#include "voxel/octree.h"

namespace octotomy::convert {

/// A surface with whole numbers for coordinates: half voxel edges from the universe's corner, so that corners
/// of voxels are even and the centre of voxel (0, 0, 0) is (1, 1, 1). Counter-clockwise seen from outside in
/// a right-handed index space.
struct LatticeSurface {
  voxel::Universe universe;
  std::vector<glm::ivec3> points_half;
  std::vector<std::array<std::uint32_t, 3>> faces;
};

/// Which voxels are one object where no face joins them. Where only a corner does, no manifold can join them,
/// and they are parted.
enum class Touching {
  Apart,    ///< neighbours share a face: the surface parts what meets at edges
  Together  ///< neighbours share a face or an edge: the surface runs through between the voxels outside
};

/// The cuberille (thesis 3.1.2.2) as a mesh: the exact boundary of a set of voxels, two triangles a face that
/// borders a voxel outside the set or the universe's end. Always closed, oriented and manifold: where faces
/// meet at an edge or corner in more than one sheet, each sheet has points of its own at the same place, as
/// `touching` says which belong together. Such sheets touch, so that a reader that welds points by place
/// (STL) finds them joined again. Where two sheets run along the same edge between the same two points, one
/// bends through a point half way: its faces are four triangles and more.
/// Six volumes are 48 times the number of voxels as an integer, and the area the number of faces. Throws
/// std::length_error where 32 bits do not number points or triangles. Parallel; same bits on any thread
/// count. Cost: slices of side^2 / 8 bytes, the faces; memory five bytes a corner of two layers a thread.
/// Source: Herman, Liu, "Three-dimensional display of human organs from computed tomograms", CGIP 9, 1979.
/// That sheets about a corner are the loops of marching cubes' case there is their duality.
LatticeSurface cuberille(const voxel::Octree& octree, Touching touching = Touching::Apart);

/// In LPS millimetres, counter-clockwise seen from outside whatever the universe's handedness.
brep::Triangles triangles_of(const LatticeSurface& surface);

}  // namespace octotomy::convert
