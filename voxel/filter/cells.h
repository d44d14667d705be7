// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/lattice.h"

// Sets of cells. A cell is a block of samples, for filter steps that do not need single samples.
namespace octotomy::voxel {

/// A flag for each cell of a grid, x fastest.
using Cells = std::vector<std::uint8_t>;

struct CellGrid {
  glm::ivec3 factor{1}, dims{0};  ///< number of samples along a cell's edges, and of cells along the axes
  glm::dvec3 mm{1.0};             ///< edges of a cell

  /// Chooses cells whose edges are as near to `cell_mm` as whole samples allow. The last cell of an axis may
  /// reach beyond the lattice.
  CellGrid(const Lattice& lattice, double cell_mm);
  std::size_t count() const;
  std::size_t at(const glm::ivec3& p) const;
  bool holds(const glm::ivec3& p) const;
  glm::ivec3 cell(std::size_t i) const;
};

/// For each cell the squared distance in mm^2 to the nearest cell that is set or, with `to_unset`, to the
/// nearest one that is not. Positions outside the grid count as neither.
std::vector<float> distances(const CellGrid& grid, const Cells& set, bool to_unset = false);

/// dilated(): the cells at most the radius from the set. eroded(): the cells of the set farther than the
/// radius from all cells outside the set.
Cells dilated(const CellGrid& grid, const Cells& set, double radius_mm);
Cells eroded(const CellGrid& grid, const Cells& set, double radius_mm);

/// Dilates by `edge_mm` plus half a cell along each axis, and by at least one cell.
Cells with_edge(const CellGrid& grid, const Cells& set, double edge_mm);

/// The cells whose squared distance, from distances(), exceeds the square of the radius.
Cells deeper(const std::vector<float>& square_mm2, double radius_mm);

/// The parts of a set whose cells are connected by faces, as cell numbers. Parts are in the order of their
/// first cells.
std::vector<std::vector<std::size_t>> parts_of(const CellGrid& grid, const Cells& set);

Cells cells_of(const CellGrid& grid, const std::vector<std::size_t>& part);

/// Adds to the set, in each plane across the axis `along`, the holes that the set encloses.
void fill_slices(const CellGrid& grid, Cells& set, int along);

}  // namespace octotomy::voxel
