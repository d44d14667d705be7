// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 list the planes of both surfaces along each axis; 2 number each point by its three planes; 3 follow the
// line along x through each row of cells and count where it enters and leaves each surface; 4 combine the
// cells; 5 draw the faces between cells that are in and cells that are out.
#include "brep/boolean/rectilinear.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/split_fans.h"

namespace octotomy::brep {
namespace {

constexpr std::size_t most_cells = 4'000'000;

using Place = std::array<int, 3>;  // numbers of planes

/// The planes along each axis, which divide space into cells.
class Grid {
 public:
  Grid(const std::array<const Triangles*, 2>& surfaces, double tolerance_mm) {
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<double> all;
      for (const Triangles* surface : surfaces)
        for (const glm::dvec3& p : surface->points_mm) all.push_back(p[static_cast<int>(k)]);
      std::sort(all.begin(), all.end());
      for (const double mm : all)
        if (planes_mm_[k].empty() || mm - last_mm_[k].back() > tolerance_mm) {
          planes_mm_[k].push_back(mm);
          last_mm_[k].push_back(mm);
        } else {
          last_mm_[k].back() = mm;
        }
    }
  }

  /// Cells along an axis.
  int count(std::size_t axis) const { return static_cast<int>(planes_mm_[axis].size()) - 1; }
  bool is_small() const {
    std::size_t cells = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      if (count(k) < 1) return false;
      cells *= static_cast<std::size_t>(count(k));
      if (cells > most_cells) return false;
    }
    return true;
  }
  std::size_t cells() const {
    return static_cast<std::size_t>(count(0)) * static_cast<std::size_t>(count(1)) *
           static_cast<std::size_t>(count(2));
  }
  std::size_t cell(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(count(0)) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(count(1)) * static_cast<std::size_t>(z));
  }

  Place place_of(const glm::dvec3& p) const {
    Place place;
    for (std::size_t k = 0; k < 3; ++k)
      place[k] =
          static_cast<int>(std::lower_bound(last_mm_[k].begin(), last_mm_[k].end(), p[static_cast<int>(k)]) -
                           last_mm_[k].begin());
    return place;
  }
  glm::dvec3 point_of(const Place& place) const {
    glm::dvec3 p;
    for (std::size_t k = 0; k < 3; ++k)
      p[static_cast<int>(k)] = planes_mm_[k][static_cast<std::size_t>(place[k])];
    return p;
  }

 private:
  std::array<std::vector<double>, 3> planes_mm_, last_mm_;  ///< least and largest coordinate of each plane
};

using Cells = std::vector<std::int8_t>;

/// Twice the signed area of a triangle projected along x; coordinates are numbers of planes.
long turn(const Place& p, const Place& q, const Place& r) {
  return static_cast<long>(q[1] - p[1]) * (r[2] - p[2]) - static_cast<long>(q[2] - p[2]) * (r[1] - p[1]);
}

/// How the line along x through a row of cells crosses the triangle: +1 or -1 by the triangle's orientation,
/// or 0 if it does not. The line is moved off the cells' middles by an infinitesimal distance, so that it
/// meets no side of a triangle.
int crossing(const std::array<Place, 3>& corners, int y, int z) {
  int inside = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Place &p = corners[k], &q = corners[(k + 1) % 3];
    const long dy = q[1] - p[1], dz = q[2] - p[2];
    // Twice the signed area of the triangle of the side's ends and the cell's middle. If it is 0, the sign
    // that it has after the middle is moved a little along y or, if it stays 0, along z.
    long side = dy * (2L * (z - p[2]) + 1) - dz * (2L * (y - p[1]) + 1);
    if (side == 0) side = dz != 0 ? -dz : dy;
    if (side == 0) return 0;
    inside += side > 0 ? 1 : -1;
  }
  return inside == 3 ? 1 : inside == -3 ? -1 : 0;
}

/// The cells inside a surface; none if a triangle is not square to any axis, or if the surface winds around a
/// cell other than 0 or 1 times.
std::optional<Cells> cells_in(const Triangles& surface, const Grid& grid) {
  std::vector<Place> places;
  places.reserve(surface.points_mm.size());
  for (const glm::dvec3& p : surface.points_mm) places.push_back(grid.place_of(p));
  Cells cells(grid.cells(), 0);
  for (const auto& face : surface.faces) {
    const std::array<Place, 3> corners{places[face[0]], places[face[1]], places[face[2]]};
    const auto is_square_to = [&](std::size_t k) {
      return corners[0][k] == corners[1][k] && corners[1][k] == corners[2][k];
    };
    if (!is_square_to(0)) {
      if (!is_square_to(1) && !is_square_to(2)) return std::nullopt;
      continue;
    }
    if (turn(corners[0], corners[1], corners[2]) == 0 || corners[0][0] >= grid.count(0)) continue;
    const auto [low_y, high_y] = std::minmax({corners[0][1], corners[1][1], corners[2][1]});
    const auto [low_z, high_z] = std::minmax({corners[0][2], corners[1][2], corners[2][2]});
    for (int z = low_z; z < high_z; ++z)
      for (int y = low_y; y < high_y; ++y)
        // Where a face's normal points along +x, the line leaves the solid.
        cells[grid.cell(corners[0][0], y, z)] =
            static_cast<std::int8_t>(cells[grid.cell(corners[0][0], y, z)] - crossing(corners, y, z));
  }
  for (int z = 0; z < grid.count(2); ++z)
    for (int y = 0; y < grid.count(1); ++y)
      for (int x = 0; x < grid.count(0); ++x) {
        std::int8_t& here = cells[grid.cell(x, y, z)];
        if (x > 0) here = static_cast<std::int8_t>(here + cells[grid.cell(x - 1, y, z)]);
        if (here != 0 && here != 1) return std::nullopt;
      }
  return cells;
}

/// Divides each side at which more than two triangles meet, at the same point in all of them. Each sheet that
/// touches the side then has separate points, and a later motion rounds equal points equally.
void divide_pinched_sides(Triangles& surface) {
  using Side = std::pair<std::uint32_t, std::uint32_t>;
  const auto side_of = [](std::uint32_t v, std::uint32_t w) { return Side(std::min(v, w), std::max(v, w)); };
  std::vector<Side> sides, pinched;
  for (const auto& face : surface.faces)
    for (std::size_t k = 0; k < 3; ++k) sides.push_back(side_of(face[k], face[(k + 1) % 3]));
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 2; i < sides.size(); ++i)
    if (sides[i] == sides[i - 2] && (pinched.empty() || pinched.back() != sides[i]))
      pinched.push_back(sides[i]);
  const auto first = static_cast<std::uint32_t>(surface.points_mm.size());
  for (const Side& side : pinched)
    surface.points_mm.push_back(0.5 * (surface.points_mm[side.first] + surface.points_mm[side.second]));
  for (std::size_t f = 0; f < surface.faces.size() && !pinched.empty(); ++f)
    for (std::size_t k = 0; k < 3;) {
      const std::array<std::uint32_t, 3> face = surface.faces[f];
      const std::uint32_t from = face[k], to = face[(k + 1) % 3], tip = face[(k + 2) % 3];
      const auto found = std::lower_bound(pinched.begin(), pinched.end(), side_of(from, to));
      if (found == pinched.end() || *found != side_of(from, to)) {
        ++k;
        continue;
      }
      const std::uint32_t middle = first + static_cast<std::uint32_t>(found - pinched.begin());
      surface.faces[f] = {from, middle, tip};
      surface.faces.push_back({middle, to, tip});
      k = 0;
    }
}

/// The faces between a cell inside and one outside.
Triangles boundary_of(const Cells& cells, const Grid& grid) {
  Triangles boundary;
  const int along_x = grid.count(0) + 1, along_y = grid.count(1) + 1;
  std::vector<std::uint32_t> numbers(static_cast<std::size_t>(along_x) * static_cast<std::size_t>(along_y) *
                                         static_cast<std::size_t>(grid.count(2) + 1),
                                     static_cast<std::uint32_t>(-1));
  const auto number = [&](const Place& place) {
    std::uint32_t& known =
        numbers[static_cast<std::size_t>(place[0]) +
                static_cast<std::size_t>(along_x) *
                    (static_cast<std::size_t>(place[1]) +
                     static_cast<std::size_t>(along_y) * static_cast<std::size_t>(place[2]))];
    if (known == static_cast<std::uint32_t>(-1)) {
      known = static_cast<std::uint32_t>(boundary.points_mm.size());
      boundary.points_mm.push_back(grid.point_of(place));
    }
    return known;
  };
  const auto is_in = [&](const Place& at) {
    for (std::size_t k = 0; k < 3; ++k)
      if (at[k] < 0 || at[k] >= grid.count(k)) return false;
    return cells[grid.cell(at[0], at[1], at[2])] != 0;
  };
  for (int z = 0; z < grid.count(2); ++z)
    for (int y = 0; y < grid.count(1); ++y)
      for (int x = 0; x < grid.count(0); ++x) {
        if (!is_in({x, y, z})) continue;
        for (std::size_t k = 0; k < 3; ++k)
          for (const int up : {0, 1}) {
            Place at{x, y, z}, beside = at;
            beside[k] += up == 1 ? 1 : -1;
            if (is_in(beside)) continue;
            at[k] += up;
            std::array<Place, 4> corners{at, at, at, at};
            const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
            ++corners[1][u], ++corners[2][u], ++corners[2][v], ++corners[3][v];
            if (up == 0) std::swap(corners[1], corners[3]);
            boundary.faces.push_back({number(corners[0]), number(corners[1]), number(corners[2])});
            boundary.faces.push_back({number(corners[0]), number(corners[2]), number(corners[3])});
          }
      }
  divide_pinched_sides(boundary);
  return in_coordinate_order(mesh_of(split_fans(boundary).surface));
}

}  // namespace

std::optional<Results> rectilinear_results(const Triangles& a, const Triangles& b, const Wanted& wanted,
                                           double tolerance_mm) {
  assert(tolerance_mm >= 0.0);
  const Grid grid({&a, &b}, tolerance_mm);
  if (!grid.is_small()) return std::nullopt;
  const std::optional<Cells> in_a = cells_in(a, grid);
  if (!in_a) return std::nullopt;
  const std::optional<Cells> in_b = cells_in(b, grid);
  if (!in_b) return std::nullopt;
  Results results;
  for (std::size_t r = 0; r < results.size(); ++r) {
    if (!wanted[r]) continue;
    Cells cells(grid.cells());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const bool of_a = (*in_a)[i] != 0, of_b = (*in_b)[i] != 0;
      cells[i] = r == of_union          ? of_a || of_b
                 : r == of_intersection ? of_a && of_b
                 : r == of_a_minus_b    ? of_a && !of_b
                                        : of_b && !of_a;
    }
    results[r] = boundary_of(cells, grid);
  }
  return results;
}

}  // namespace octotomy::brep
