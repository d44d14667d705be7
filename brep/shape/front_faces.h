// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Right-handed axes with z along a direction; exact where the direction is one of the patient's axes.
struct ViewAxes {
  explicit ViewAxes(const glm::dvec3& direction);

  glm::dmat3 lps_from_view{1.0};

  glm::dvec3 seen(const glm::dvec3& p_mm) const { return p_mm * lps_from_view; }
  glm::dvec3 lps(const glm::dvec3& p_view) const { return lps_from_view * p_view; }
};

/// The triangles of a closed surface that face a direction, as seen along it. Points are (x, y, depth) in the
/// view's axes.
class FrontFaces {
 public:
  static constexpr std::uint32_t none = Linked::none;

  /// Precondition: the surface is closed, and `points` are its points. `surface` and `points` must outlive
  /// this object.
  FrontFaces(const Linked& surface, const std::vector<glm::dvec3>& points);

  /// The triangles that may be seen, ascending. Triangles wholly behind sheets without a gap are left out,
  /// because they are nowhere visible.
  const std::vector<std::uint32_t>& seen() const { return seen_; }
  bool is_seen(std::uint32_t triangle) const { return is_seen_[triangle] != 0; }
  /// The first triangle on the line of sight through a point, or none.
  std::uint32_t first_at(const glm::dvec2& at) const;
  /// The depth of a triangle's plane at a point, limited to the depths of the triangle's corners.
  double depth(std::uint32_t triangle, const glm::dvec2& at) const;

 private:
  using Corners = std::array<glm::dvec3, 3>;
  Corners corners(std::uint32_t triangle) const;
  bool covers(std::uint32_t triangle, const glm::dvec2& at) const;
  glm::ivec2 cell_of(const glm::dvec2& at) const;
  std::size_t index(const glm::ivec2& cell) const;
  void sort_into_cells(const std::vector<std::uint32_t>& triangles);
  double depth_of_cover(std::size_t cell, const std::vector<std::uint8_t>& is_front) const;
  void leave_out_hidden(const std::vector<std::uint32_t>& front, const std::vector<std::uint8_t>& is_front);

  const Linked& surface_;
  const std::vector<glm::dvec3>& points_;
  glm::dvec2 low_{0.0};
  double cell_mm_ = 1.0;
  glm::ivec2 dims_{1};
  std::vector<std::uint32_t> first_;  ///< of a cell's triangles
  std::vector<std::uint32_t> in_cell_;
  std::vector<std::uint32_t> seen_;
  std::vector<std::uint8_t> is_seen_;
};

}  // namespace octotomy::brep
