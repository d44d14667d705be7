// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/lattice.h"

// Sets of cells, each a block of whole samples, for filter steps that do not need single samples.
namespace octotomy::voxel {

/// A flag for each cell of a grid, x fastest.
using Cells = std::vector<std::uint8_t>;

struct CellGrid {
  glm::ivec3 factor{1}, dims{0};  ///< samples along a cell's edges, cells along the axes
  glm::dvec3 mm{1.0};             ///< edges of a cell

  /// Chooses cells whose edges are as near to `cell_mm` as whole samples allow. The last cell of an axis may
  /// reach beyond the lattice.
  CellGrid(const Lattice& lattice, double cell_mm);
  std::size_t count() const;
  std::size_t at(const glm::ivec3& p) const;
  bool holds(const glm::ivec3& p) const;
  glm::ivec3 cell(std::size_t i) const;
};

/// Squared distances in mm^2 to the cells that are set or, with `to_unset`, to those that are not. Positions
/// outside the grid belong to neither.
std::vector<float> distances(const CellGrid& grid, const Cells& set, bool to_unset = false);

/// dilated(): the cells within the radius of the set. eroded(): the cells of the set that lie deeper than the
/// radius.
Cells dilated(const CellGrid& grid, const Cells& set, double radius_mm);
Cells eroded(const CellGrid& grid, const Cells& set, double radius_mm);

/// Dilates by `edge_mm` plus half a cell along each axis, and by at least one cell.
Cells with_edge(const CellGrid& grid, const Cells& set, double edge_mm);

/// The cells whose squared distance is larger than the square of the radius.
Cells deeper(const std::vector<float>& square_mm2, double radius_mm);

/// Parts joined by faces, in the order of their first cells.
std::vector<std::vector<std::size_t>> parts_of(const CellGrid& grid, const Cells& set);

Cells cells_of(const CellGrid& grid, const std::vector<std::size_t>& part);

/// Fills, in each plane across an axis, the holes that the set encloses.
void fill_slices(const CellGrid& grid, Cells& set, int along);

}  // namespace octotomy::voxel
