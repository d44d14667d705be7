// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <tbb/parallel_for.h>
#include <vector>

#include "brep/mesh/triangles.h"
#include "voxel/space/large_allocator.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::convert {

// Marching cubes for the sources of this room. Each source has its own rule for the inside and for
// crossings.

/// One bit for each sample of the padded lattice, set inside. A row along x takes whole words: it starts with
/// `before` bits of padding, which are outside, and ends with at least one.
struct InsideBits {
  InsideBits(const glm::ivec3& dims, int before)
      : padding(before, 1, 1),
        rows_y(static_cast<std::size_t>(dims.y) + 2),
        planes_z(static_cast<std::size_t>(dims.z) + 2),
        words(static_cast<std::size_t>(dims.x + before + 1) / 64 + 1),
        bits(rows_y * planes_z * words) {
    tbb::parallel_for(std::size_t{0}, planes_z,
                      [&](std::size_t z) { std::fill_n(row(0, z), rows_y * words, 0); });
  }

  std::size_t row_number(std::size_t y, std::size_t z) const { return z * rows_y + y; }
  const std::uint64_t* row(std::size_t y, std::size_t z) const { return &bits[row_number(y, z) * words]; }
  std::uint64_t* row(std::size_t y, std::size_t z) { return &bits[row_number(y, z) * words]; }

  glm::ivec3 padding;  ///< number of places before the first sample, along each axis
  std::size_t rows_y, planes_z, words;
  std::vector<std::uint64_t, voxel::LargeAllocator<std::uint64_t>> bits;
};

/// The bits of an octree's voxels.
InsideBits inside_bits(const voxel::Octree& octree);

/// The edge of a lattice from a voxel to the next one along an axis. Exactly one of its ends is inside.
struct CrossedEdge {
  glm::ivec3 voxel;
  std::uint8_t axis;
  bool first_inside;
};

/// Writes where each edge is crossed, as a part of the edge strictly between 0 and 1. Called from several
/// threads with some hundred edges at a time, mostly neighbours.
using Crossings = std::function<void(std::span<const CrossedEdge> edges, double* parts)>;

/// The closed surface about the inside samples of a lattice, in LPS millimetres, oriented outward. An edge
/// that leaves the lattice is crossed half way. Throws voxel::Error (Resource) if there are more triangles
/// than 32-bit numbers can name; voxel::Stopped. Parallel; same bits on any thread count.
brep::Triangles extract_surface(const voxel::Lattice& lattice, const InsideBits& inside,
                                const Crossings& crossings, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
