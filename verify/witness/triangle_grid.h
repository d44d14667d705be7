// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "brep/mesh/triangles.h"

// Distances to triangles, and sides of closed surfaces. The kernels' search trees and their digitisation
// share no code with it.
namespace octotomy::verify {

/// Boxes, sorted into the cells of a regular grid that they overlap.
class BoxGrid {
 public:
  struct Box {
    glm::dvec3 low_mm{0.0}, high_mm{0.0};
  };
  BoxGrid() = default;
  /// Cells have at least the edge `cell_mm`. The edge is longer where the boxes would fill too many cells.
  BoxGrid(const std::vector<Box>& boxes, double cell_mm);

  bool empty() const { return items_.empty(); }
  double cell_mm() const { return cell_mm_; }
  const glm::ivec3& dims() const { return dims_; }
  /// The cell of a point. For a point outside the grid it is a cell outside the grid.
  glm::ivec3 cell_of(const glm::dvec3& p_mm) const;
  bool has(const glm::ivec3& cell) const;
  /// The distance of a point from a cell, up to rounding.
  double distance_mm(const glm::ivec3& cell, const glm::dvec3& p_mm) const;
  /// Calls `visit` with the number of each box that overlaps a cell of the grid. Stops when `visit` returns true.
  template <typename Visit>
  bool any_in(const glm::ivec3& cell, const Visit& visit) const {
    const std::size_t i = index(cell);
    for (std::size_t k = first_[i]; k < first_[i + 1]; ++k)
      if (visit(items_[k])) return true;
    return false;
  }

 private:
  std::size_t index(const glm::ivec3& cell) const;

  double cell_mm_ = 1.0;
  glm::dvec3 low_mm_{0.0};
  glm::ivec3 dims_{0};
  std::vector<std::uint32_t> first_, items_;
};

/// Triangles in LPS millimetres, in the cells of a grid. Safe to read from several threads.
class TriangleGrid {
 public:
  explicit TriangleGrid(brep::Triangles triangles);

  const brep::Triangles& triangles() const { return triangles_; }

  /// The point of the triangles that is nearest to a given point.
  struct Foot {
    double distance_mm = 0.0;
    std::uint32_t face = 0;
    glm::dvec3 weights{0.0};  ///< of the face's corners
  };
  /// Returns none if all triangles are farther away than `most_mm`. The search ends at the first distance
  /// below `enough_mm`, which need not be the smallest one.
  std::optional<Foot> nearest(const glm::dvec3& p_mm, double most_mm, double enough_mm = 0.0) const;
  bool has_within(const glm::dvec3& p_mm, double reach_mm) const;
  /// Whether a ray along x from the point crosses an odd number of triangles. A crossing through an edge or a
  /// corner counts once. Precondition: the surface is closed.
  bool has_inside(const glm::dvec3& p_mm) const;

 private:
  brep::Triangles triangles_;
  BoxGrid cells_;  ///< of the triangles
  BoxGrid rows_;   ///< of the triangles' projections along x
};

}  // namespace octotomy::verify
