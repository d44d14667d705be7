// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 On a lattice of two cells a voxel, a cell is kept if all voxels that it touches are inside. Cell 2k + 1
//   is the middle of voxel k, cell 2k the middle of the wall between voxels k - 1 and k. As sets of unit
//   cells this is the intersection of the doubled set's eight translates by 0 or 1. The kept set is well
//   composed: if two of its cells met only at an edge or corner, a cell between them would touch only voxels
//   that these two touch, so it would be kept as well.
// 2 A cell becomes `cell` refined voxels a side, cell a power of two above the number of sets; set i is
//   shifted by i + 1 refined voxels downwards. Its planes then lie at -(i + 1) modulo `cell`: no two sets
//   share one, and none lies on the border, which is 0. The shift is at most half a voxel; step 1 leaves that
//   much free at the low end.
// All cells are cubes, so diagonals of their faces have slope one and meet every plane at integers.
#include "verify/certificate/general_position.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "brep/mesh/triangles.h"
#include "convert/surface/cuberille.h"
#include "voxel/solid/combine.h"
#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

/// A universe of cubic voxels with this edge. The lowest corner is at (first_mm, first_mm, first_mm).
voxel::Universe cubes(int depth, double edge_mm, double first_mm) {
  voxel::Universe universe;
  universe.depth = depth;
  universe.lps_from_voxel = glm::dmat4(edge_mm);
  universe.lps_from_voxel[3] = glm::dvec4(glm::dvec3(first_mm + 0.5 * edge_mm), 1.0);
  return universe;
}

glm::dmat4 translation(const glm::dvec3& by_mm) {
  glm::dmat4 matrix(1.0);
  matrix[3] = glm::dvec4(by_mm, 1.0);
  return matrix;
}

/// Step 1 above. Returns the kept cells of a set as voxels of one millimetre.
voxel::Octree parted(const voxel::Octree& set) {
  const int depth = set.universe().depth;
  const voxel::Universe fine = cubes(depth + 1, 1.0, 0.0);
  const voxel::Octree doubled =
      voxel::combine(fine, voxel::Octree(cubes(depth, 2.0, 0.0), voxel::Block::share(set.root())));
  voxel::Expression kept = doubled;
  for (int corner = 1; corner < 8; ++corner)
    kept =
        kept & moved(voxel::Expression(doubled), translation({corner & 1, (corner >> 1) & 1, corner >> 2}));
  return voxel::combine(fine, kept);
}

}  // namespace

GeneralPosition general_position(const std::vector<voxel::Octree>& sets, const voxel::Progress& progress) {
  if (sets.empty()) throw voxel::InvalidInput("general position needs at least one set of voxels");
  const int depth = sets.front().universe().depth;
  int cell = 2, doublings = 2;
  for (; cell <= static_cast<int>(sets.size()); cell *= 2) ++doublings;
  if (depth + doublings > voxel::Universe::max_depth)
    throw voxel::Error(voxel::ErrorCode::Resource,
                       "general position of " + std::to_string(sets.size()) + " sets takes a lattice of 2^" +
                           std::to_string(depth + doublings) + " voxels a side, 2^" +
                           std::to_string(voxel::Universe::max_depth) +
                           " is the largest: take fewer operands or a smaller universe");
  GeneralPosition position;
  position.refinement = 2 * cell;
  position.universe = cubes(depth + doublings, 1.0, 0.0);
  int shift = 0;
  for (const voxel::Octree& set : sets) {
    if (!(set.universe() == sets.front().universe()))
      throw voxel::InvalidInput("general position: all sets of voxels must have the same universe");
    progress.at(static_cast<double>(shift) / static_cast<double>(sets.size()));
    ++shift;
    const voxel::Octree cells = parted(set);
    const voxel::Universe placed = cubes(depth + 1, cell, -shift);
    const convert::LatticeSurface surface = convert::cuberille(cells);
    brep::Triangles triangles;
    triangles.faces = surface.faces;
    for (const glm::ivec3& p_half : surface.points_half)
      triangles.points_mm.push_back(glm::dvec3(p_half * (cell / 2) - shift));
    position.operands.push_back(
        {voxel::combine(position.universe, voxel::Octree(placed, voxel::Block::share(cells.root()))),
         brep::trusted_solid(std::move(triangles), brep::Proof::Construction)});
  }
  return position;
}

}  // namespace octotomy::verify
