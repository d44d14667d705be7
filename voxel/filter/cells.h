// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/space/lattice.h"

// Sets of cells, each a block of whole samples: what filters compute that need no single sample.
namespace octotomy::voxel {

/// A flag for each cell of a grid, x fastest.
using Cells = std::vector<std::uint8_t>;

struct CellGrid {
  glm::ivec3 factor{1}, dims{0};  ///< samples along a cell's edges, cells along the axes
  glm::dvec3 mm{1.0};             ///< edges of a cell

  /// Cells whose edges come nearest to `cell_mm`. The last cell of an axis may reach beyond the lattice.
  CellGrid(const Lattice& lattice, double cell_mm);
  std::size_t count() const;
  std::size_t at(const glm::ivec3& p) const;
  bool holds(const glm::ivec3& p) const;
  glm::ivec3 cell(std::size_t i) const;
};

/// Squared distances in mm2 to the cells that are set, or to those that are not. Outside of the grid is
/// neither.
std::vector<float> distances(const CellGrid& grid, const Cells& set, bool to_unset = false);

/// The cells within the radius of a set; those of a set that lie deeper than the radius.
Cells dilated(const CellGrid& grid, const Cells& set, double radius_mm);
Cells eroded(const CellGrid& grid, const Cells& set, double radius_mm);

/// Dilates by a length plus half a cell along each axis, and by one cell at least.
Cells with_edge(const CellGrid& grid, const Cells& set, double edge_mm);

/// The cells whose squared distance is larger than that of the radius.
Cells deeper(const std::vector<float>& square_mm2, double radius_mm);

/// Parts joined by faces, in the order of their first cells.
std::vector<std::vector<std::size_t>> parts_of(const CellGrid& grid, const Cells& set);

Cells cells_of(const CellGrid& grid, const std::vector<std::size_t>& part);

/// Fills what the set encloses in each plane across an axis.
void fill_slices(const CellGrid& grid, Cells& set, int along);

}  // namespace octotomy::voxel
