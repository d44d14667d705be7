// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 rotate both surfaces about x and distribute their triangles to slabs of rows; 2 for each row that a
// triangle crosses, list the lines between its two sides with their crossing points; 3 distribute the
// crossings of a row to its lines; 4 follow each line and sum the lengths inside.
#include "brep/mesh/line_volume.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <tbb/parallel_for.h>
#include <tuple>
#include <vector>

#include "brep/mesh/row_crossing.h"

namespace octotomy::brep {
namespace {

constexpr std::int64_t rows_a_slab = 8;
/// As many crossings as a million lines have with 64 layers. Surfaces with more layers are sampled by fewer
/// lines.
constexpr double most_crossings = 0x1p26;

/// A crossing of a line of a row and a triangle.
struct Hit {
  double x;
  std::uint32_t column;
  std::int8_t enters;  // 1 or -1
  std::uint8_t surface;
};

struct Lines {
  double low_y = 0.0, low_z = 0.0, spacing = 1.0;
  std::int64_t columns = 0, rows = 0;
  double y(std::int64_t column) const { return low_y + spacing * static_cast<double>(column); }
  double z(std::int64_t row) const { return low_z + spacing * static_cast<double>(row); }
  /// The number of the first line at or above a coordinate.
  static std::int64_t first(double at, double low, double spacing, std::int64_t count) {
    const double number = std::ceil((at - low) / spacing);
    auto k = static_cast<std::int64_t>(std::clamp(number, 0.0, static_cast<double>(count)));
    while (k > 0 && low + spacing * static_cast<double>(k - 1) >= at) --k;
    while (k < count && low + spacing * static_cast<double>(k) < at) ++k;
    return k;
  }
};

/// The surface rotated about x, so that flat faces along the axes, which whole rows of lines would either hit
/// or miss, are oblique to the rows.
Triangles turned(const Triangles& surface) {
  constexpr double angle_rad = 0.6180339887;
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  Triangles done{{}, surface.faces};
  done.points_mm.reserve(surface.points_mm.size());
  for (const glm::dvec3& p : surface.points_mm)
    done.points_mm.emplace_back(p.x, c * p.y - s * p.z, s * p.y + c * p.z);
  return done;
}

Lines lines_over(const Triangles& a, const Triangles& b, std::size_t count) {
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  double passed_mm2 = 0.0;  // total area of the triangles' projections along x
  for (const Triangles* surface : {&a, &b})
    for (const auto& face : surface->faces) {
      for (const std::uint32_t v : face) {
        low = glm::min(low, surface->points_mm[v]);
        high = glm::max(high, surface->points_mm[v]);
      }
      passed_mm2 +=
          shadow_mm2({surface->points_mm[face[0]], surface->points_mm[face[1]], surface->points_mm[face[2]]});
    }
  const glm::dvec3 extent = high - low;
  Lines lines;
  if (!(extent.y > 0.0 && extent.z > 0.0)) return lines;
  lines.spacing = std::sqrt(extent.y * extent.z / static_cast<double>(count));
  lines.spacing = std::max(lines.spacing, std::max(extent.y, extent.z) / static_cast<double>(count));
  lines.spacing = std::max(lines.spacing, std::sqrt(passed_mm2 / most_crossings));
  // Not a simple fraction, so that lines avoid edges and planes at round coordinates.
  lines.low_y = low.y + 0.4159265358 * lines.spacing;
  lines.low_z = low.z + 0.5182818284 * lines.spacing;
  lines.columns = static_cast<std::int64_t>(extent.y / lines.spacing) + 1;
  lines.rows = static_cast<std::int64_t>(extent.z / lines.spacing) + 1;
  assert(lines.columns <= std::numeric_limits<std::uint32_t>::max());
  return lines;
}

void add_hits(const std::array<glm::dvec3, 3>& t, std::uint8_t surface, const Lines& lines, double z,
              std::vector<Hit>& hits) {
  const std::optional<RowCrossing> crossing = row_crossing(t, z);
  if (!crossing) return;
  const std::int64_t begin = Lines::first(crossing->low_y, lines.low_y, lines.spacing, lines.columns);
  const std::int64_t end = Lines::first(crossing->high_y, lines.low_y, lines.spacing, lines.columns);
  for (std::int64_t column = begin; column < end; ++column)
    hits.push_back({crossing->x_at(lines.y(column)), static_cast<std::uint32_t>(column),
                    static_cast<std::int8_t>(crossing->enters), surface});
}

/// The hits of one row, ordered by line and then by x.
class RowOfHits {
 public:
  explicit RowOfHits(const Lines& lines) : ends_(static_cast<std::size_t>(lines.columns)) {}

  void sort(const std::vector<Hit>& hits) {
    std::fill(ends_.begin(), ends_.end(), 0);
    for (const Hit& hit : hits) ++ends_[hit.column];
    std::exclusive_scan(ends_.begin(), ends_.end(), ends_.begin(), std::size_t{0});
    sorted_.resize(hits.size());
    for (const Hit& hit : hits) sorted_[ends_[hit.column]++] = hit;
    for (std::size_t column = 0; column < ends_.size(); ++column) {
      const std::span<Hit> line = of(column);
      std::sort(line.begin(), line.end(), [](const Hit& p, const Hit& q) {
        return std::tie(p.x, p.surface, p.enters) < std::tie(q.x, q.surface, q.enters);
      });
    }
  }
  std::span<Hit> of(std::size_t column) {
    const std::size_t begin = column == 0 ? 0 : ends_[column - 1];
    return std::span(sorted_).subspan(begin, ends_[column] - begin);
  }

 private:
  std::vector<std::size_t> ends_;  // end of each line's hits
  std::vector<Hit> sorted_;
};

struct Sums {
  std::array<LineVolume, 2> halves;  // lengths
  std::size_t lines = 0, open_lines = 0;
};

/// Adds the lengths along one line, from its hits in order of x.
void follow(std::span<const Hit> line, std::int64_t row, Sums& sums) {
  ++sums.lines;
  std::array<int, 2> winding{};
  for (const Hit& hit : line) winding[hit.surface] += hit.enters;
  if (winding[0] != 0 || winding[1] != 0) {
    ++sums.open_lines;
    return;
  }
  LineVolume& own = sums.halves[static_cast<std::size_t>((row + line[0].column) & 1)];
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    winding[line[i].surface] += line[i].enters;
    const double length = line[i + 1].x - line[i].x;
    if (winding[0] != 0) own.a_mm3 += length;
    if (winding[1] != 0) own.b_mm3 += length;
    if (winding[0] != 0 && winding[1] != 0) own.common_mm3 += length;
  }
}

/// The triangles that cross the rows of each slab, numbered with those of b after those of a.
std::vector<std::vector<std::uint32_t>> deal(const Triangles& a, const Triangles& b, const Lines& lines) {
  std::vector<std::vector<std::uint32_t>> slabs(
      static_cast<std::size_t>((lines.rows + rows_a_slab - 1) / rows_a_slab));
  std::uint32_t number = 0;
  for (const Triangles* surface : {&a, &b})
    for (const auto& face : surface->faces) {
      const double p = surface->points_mm[face[0]].z, q = surface->points_mm[face[1]].z,
                   r = surface->points_mm[face[2]].z;
      const std::int64_t first =
          Lines::first(std::min({p, q, r}), lines.low_z, lines.spacing, lines.rows) / rows_a_slab;
      const std::int64_t end = Lines::first(std::max({p, q, r}), lines.low_z, lines.spacing, lines.rows);
      for (std::int64_t slab = first; slab * rows_a_slab < end; ++slab)
        slabs[static_cast<std::size_t>(slab)].push_back(number);
      ++number;
    }
  return slabs;
}

}  // namespace

LineVolumes line_volumes(const Triangles& first, const Triangles& second, std::size_t count) {
  const Triangles a = turned(first), b = turned(second);
  const Lines lines = lines_over(a, b, std::max<std::size_t>(count, 1));
  const std::vector<std::vector<std::uint32_t>> slabs = deal(a, b, lines);
  std::vector<Sums> sums(slabs.size());
  tbb::parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t s) {
    const std::int64_t first_row = static_cast<std::int64_t>(s) * rows_a_slab;
    std::array<std::vector<Hit>, rows_a_slab> rows;
    for (const std::uint32_t number : slabs[s]) {
      const bool of_b = number >= a.faces.size();
      const Triangles& surface = of_b ? b : a;
      const auto& face = surface.faces[of_b ? number - a.faces.size() : number];
      const std::array<glm::dvec3, 3> t = {surface.points_mm[face[0]], surface.points_mm[face[1]],
                                           surface.points_mm[face[2]]};
      const double low = std::min({t[0].z, t[1].z, t[2].z}), high = std::max({t[0].z, t[1].z, t[2].z});
      const std::int64_t begin =
          std::max(first_row, Lines::first(low, lines.low_z, lines.spacing, lines.rows));
      const std::int64_t end =
          std::min(first_row + rows_a_slab, Lines::first(high, lines.low_z, lines.spacing, lines.rows));
      for (std::int64_t row = begin; row < end; ++row)
        add_hits(t, of_b ? 1 : 0, lines, lines.z(row), rows[static_cast<std::size_t>(row - first_row)]);
    }
    RowOfHits by_line(lines);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      by_line.sort(rows[r]);
      for (std::size_t column = 0; column < static_cast<std::size_t>(lines.columns); ++column)
        if (const std::span<const Hit> line = by_line.of(column); !line.empty())
          follow(line, first_row + static_cast<std::int64_t>(r), sums[s]);
    }
  });
  LineVolumes volumes;
  const double each_mm2 = lines.spacing * lines.spacing;
  for (const Sums& part : sums) {
    volumes.lines += part.lines;
    volumes.open_lines += part.open_lines;
    for (std::size_t k = 0; k < 2; ++k) {
      const LineVolume& own = part.halves[k];
      volumes.halves[k].a_mm3 += 2.0 * each_mm2 * own.a_mm3;
      volumes.halves[k].b_mm3 += 2.0 * each_mm2 * own.b_mm3;
      volumes.halves[k].common_mm3 += 2.0 * each_mm2 * own.common_mm3;
    }
  }
  const auto& [even, odd] = volumes.halves;
  volumes.all = {0.5 * (even.a_mm3 + odd.a_mm3), 0.5 * (even.b_mm3 + odd.b_mm3),
                 0.5 * (even.common_mm3 + odd.common_mm3)};
  return volumes;
}

}  // namespace octotomy::brep
