// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

#include "voxel/filter/slice_work.h"
#include "voxel/measure/distance_map.h"

namespace octotomy::voxel {
namespace {

constexpr std::array<std::array<int, 3>, 6> faces{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

}  // namespace

CellGrid::CellGrid(const Lattice& lattice, double cell_mm) {
  const glm::dvec3 spacing = lattice.spacing_mm();
  for (int k = 0; k < 3; ++k) factor[k] = std::max(1, static_cast<int>(std::lround(cell_mm / spacing[k])));
  dims = (lattice.dims + factor - 1) / factor;
  mm = spacing * glm::dvec3(factor);
}

std::size_t CellGrid::count() const {
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) *
         static_cast<std::size_t>(dims.z);
}

std::size_t CellGrid::at(const glm::ivec3& p) const {
  return sample_index(dims, p);
}

bool CellGrid::holds(const glm::ivec3& p) const {
  return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < dims.x && p.y < dims.y && p.z < dims.z;
}

glm::ivec3 CellGrid::cell(std::size_t i) const {
  const auto x = static_cast<std::size_t>(dims.x), y = static_cast<std::size_t>(dims.y);
  return {static_cast<int>(i % x), static_cast<int>(i / x % y), static_cast<int>(i / (x * y))};
}

std::vector<float> distances(const CellGrid& grid, const Cells& set, bool to_unset) {
  DistanceMap map{{glm::ivec3(0), grid.dims - 1}, {}};
  map.square_mm2.resize(grid.count());
  for (std::size_t i = 0; i < set.size(); ++i)
    map.square_mm2[i] = (set[i] != 0) != to_unset ? 0.0F : std::numeric_limits<float>::infinity();
  Universe universe;
  for (int k = 0; k < 3; ++k) universe.lps_from_voxel[k][k] = grid.mm[k];
  spread(map, universe);
  return std::move(map.square_mm2);
}

Cells deeper(const std::vector<float>& square_mm2, double radius_mm) {
  Cells result(square_mm2.size());
  for (std::size_t i = 0; i < square_mm2.size(); ++i)
    result[i] = static_cast<double>(square_mm2[i]) > radius_mm * radius_mm ? 1 : 0;
  return result;
}

Cells dilated(const CellGrid& grid, const Cells& set, double radius_mm) {
  Cells result = deeper(distances(grid, set), radius_mm);
  for (std::uint8_t& cell : result) cell ^= 1;
  return result;
}

Cells eroded(const CellGrid& grid, const Cells& set, double radius_mm) {
  return deeper(distances(grid, set, true), radius_mm);
}

Cells with_edge(const CellGrid& grid, const Cells& set, double edge_mm) {
  CellGrid scaled = grid;
  for (int k = 0; k < 3; ++k) scaled.mm[k] /= std::max(edge_mm + 0.5 * grid.mm[k], 1.001 * grid.mm[k]);
  return dilated(scaled, set, 1.0);
}

std::vector<std::vector<std::size_t>> parts_of(const CellGrid& grid, const Cells& set) {
  std::vector<std::vector<std::size_t>> parts;
  Cells seen(set.size(), 0);
  for (std::size_t first = 0; first < set.size(); ++first) {
    if (set[first] == 0 || seen[first] != 0) continue;
    std::vector<std::size_t> part{first};
    seen[first] = 1;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const glm::ivec3 p = grid.cell(part[i]);
      for (const auto& face : faces) {
        const glm::ivec3 q = p + glm::ivec3(face[0], face[1], face[2]);
        if (!grid.holds(q)) continue;
        const std::size_t next = grid.at(q);
        if (set[next] == 0 || seen[next] != 0) continue;
        seen[next] = 1;
        part.push_back(next);
      }
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

Cells cells_of(const CellGrid& grid, const std::vector<std::size_t>& part) {
  Cells cells(grid.count(), 0);
  for (const std::size_t i : part) cells[i] = 1;
  return cells;
}

void fill_slices(const CellGrid& grid, Cells& set, int along) {
  const int u = (along + 1) % 3, v = (along + 2) % 3;
  tbb::parallel_for(0, grid.dims[along], [&](int slice) {
    const glm::ivec2 size(grid.dims[u], grid.dims[v]);
    const auto index = [&](const glm::ivec2& q) {
      glm::ivec3 p(0);
      p[along] = slice;
      p[u] = q.x;
      p[v] = q.y;
      return grid.at(p);
    };
    Cells outside(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y), 0);
    std::vector<glm::ivec2> stack;
    const auto reach = [&](const glm::ivec2& q) {
      if (q.x < 0 || q.y < 0 || q.x >= size.x || q.y >= size.y) return;
      std::uint8_t& seen = outside[static_cast<std::size_t>(q.y) * static_cast<std::size_t>(size.x) +
                                   static_cast<std::size_t>(q.x)];
      if (seen != 0 || set[index(q)] != 0) return;
      seen = 1;
      stack.push_back(q);
    };
    for (int x = 0; x < size.x; ++x) reach({x, 0}), reach({x, size.y - 1});
    for (int y = 0; y < size.y; ++y) reach({0, y}), reach({size.x - 1, y});
    while (!stack.empty()) {
      const glm::ivec2 q = stack.back();
      stack.pop_back();
      for (const glm::ivec2& step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) reach(q + step);
    }
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x)
        if (outside[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) +
                    static_cast<std::size_t>(x)] == 0)
          set[index({x, y})] = 1;
  });
}

}  // namespace octotomy::voxel
