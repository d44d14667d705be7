// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/window_surface.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unordered_set>
#include <utility>
#include <vector>

#include "convert/surface/marching_cubes.h"
#include "voxel/space/shared_progress.h"

// A is the set of samples not below the window, B that of samples above it. W = A - B is the window.
//
// 1 Marching cubes of A and of B, in coordinates of samples. A cell that only one of them crosses keeps its
//   triangles; those of B are turned inside out.
// 2 Both surfaces are disjoint on the faces of cells: marching_cubes.cpp parts the inside corners of a face,
//   so the part of a face outside A or B is one convex polygon, and B's crossings lie inside A.
// 3 In a cell that both cross, the table's triangles of A and of B may cross, because neither loop is planar.
//   The cell keeps them if a plane of each pair of triangles separates the pair. Otherwise each connected
//   part of the cell's boundary that is outside B gets a convex hull, and B's triangles are replaced by the
//   facets of these hulls that span B's loops. (By 2 a part meets each face in one convex polygon, or in
//   nothing, so the hull meets the cell's boundary in that part alone. The rest of the hull's surface is one
//   disc per loop. There are two such parts only around opposite corners of the cell, and their hulls are
//   disjoint.) A's triangles have their corners in such a part, off B's loops, so they lie inside the hull
//   and do not meet the discs.
// 4 A *plain* cell has a sample that was not measured. Its triangles are those of W alone, so that the
//   surfaces around unmeasured samples, which coincide for A and B, do not appear. On a face between a plain
//   and another cell, W by itself and A - B may differ; the difference is closed by flat polygons in the
//   face. Their corners lie around the face in order, so they are convex.
// 5 If one sample of an edge lies below the window and the other above it, plain and other cells might
//   alternate around the edge. Four polygons would meet there, so these cells become plain as well.
//
// A triangle's cell follows from its centroid: no triangle of marching cubes lies in a face.

namespace octotomy::convert {
namespace {

using Face = std::array<std::uint32_t, 3>;

/// The least distance by which a plane must separate two triangles, as a part of an edge between samples.
/// Rounding to millimetres moves points by up to 2^-34 (stays_apart()).
constexpr double surely_apart = 0x1p-24;

/// Numbers the cells of the padded lattice in the order of extract_surface().
class CellNumbers {
 public:
  explicit CellNumbers(const glm::ivec3& dims) : row_(dims.x + 1), plane_(dims.y + 1) {}
  std::uint64_t number(const glm::ivec3& cell) const {
    return (static_cast<std::uint64_t>(cell.z + 1) * plane_ + static_cast<std::uint64_t>(cell.y + 1)) * row_ +
           static_cast<std::uint64_t>(cell.x + 1);
  }
  glm::ivec3 cell(std::uint64_t number) const {
    return glm::ivec3(number % row_, number / row_ % plane_, number / row_ / plane_) - 1;
  }

 private:
  std::uint64_t row_, plane_;
};

glm::ivec3 corner_offset(int corner) {
  return {corner & 1, (corner >> 1) & 1, corner >> 2};
}

bool bit_at(const InsideBits& bits, const glm::ivec3& voxel) {
  const glm::ivec3 at = voxel + bits.padding;
  const std::uint64_t* row = bits.row(static_cast<std::size_t>(at.y), static_cast<std::size_t>(at.z));
  return ((row[at.x / 64] >> (at.x % 64)) & 1) != 0;
}

int corners_in(const InsideBits& bits, const glm::ivec3& cell) {
  int corners = 0;
  for (int corner = 0; corner < 8; ++corner)
    corners |= static_cast<int>(bit_at(bits, cell + corner_offset(corner))) << corner;
  return corners;
}

std::vector<std::uint64_t> cells_of(const brep::Triangles& surface, const CellNumbers& numbers) {
  std::vector<std::uint64_t> cells(surface.faces.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t i) {
    const Face& face = surface.faces[i];
    const glm::dvec3 sum =
        surface.points_mm[face[0]] + surface.points_mm[face[1]] + surface.points_mm[face[2]];
    cells[i] = numbers.number(glm::ivec3(glm::floor(sum / 3.0)));
  });
  assert(std::is_sorted(cells.begin(), cells.end()));
  return cells;
}

/// A cell that both surfaces cross: the ranges of its triangles, and the triangles that replace them.
struct SharedCell {
  std::uint64_t number = 0;
  std::size_t low_begin = 0, low_end = 0, high_begin = 0, high_end = 0;
  bool is_replaced = false;
  std::vector<Face> triangles = {};  ///< of points of A, and of B behind those of A
};

std::vector<SharedCell> shared_cells(const std::vector<std::uint64_t>& low,
                                     const std::vector<std::uint64_t>& high) {
  std::vector<SharedCell> shared;
  std::size_t i = 0, k = 0;
  while (i < low.size() && k < high.size()) {
    if (low[i] < high[k]) {
      ++i;
    } else if (high[k] < low[i]) {
      ++k;
    } else {
      SharedCell cell{low[i], i, i, k, k};
      while (i < low.size() && low[i] == cell.number) ++i;
      while (k < high.size() && high[k] == cell.number) ++k;
      cell.low_end = i;
      cell.high_end = k;
      shared.push_back(std::move(cell));
    }
  }
  return shared;
}

/// Whether the plane of a triangle has three points on one side, all of them surely off it.
bool separates(const std::array<glm::dvec3, 3>& plane, const std::array<glm::dvec3, 3>& others) {
  const glm::dvec3 normal = glm::cross(plane[1] - plane[0], plane[2] - plane[0]);
  const double least = surely_apart * glm::length(normal);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const glm::dvec3& p : others) {
    const double side = glm::dot(normal, p - plane[0]);
    low = std::min(low, side);
    high = std::max(high, side);
  }
  return low > least || high < -least;
}

/// Appends the facets of a convex hull that span a loop, by gift wrapping: joins each edge to the corner for
/// which all others of the loop lie on the outside.
void append_hull(const std::vector<int>& loop, const std::array<glm::dvec3, 12>& at, std::size_t first,
                 std::size_t last, std::vector<std::array<int, 3>>& triangles) {
  if (last - first < 2) return;
  const glm::dvec3 &from = at[static_cast<std::size_t>(loop[first])],
                   &to = at[static_cast<std::size_t>(loop[last])];
  std::size_t apex = first + 1;
  for (std::size_t other = first + 2; other < last; ++other) {
    const glm::dvec3 normal = glm::cross(at[static_cast<std::size_t>(loop[apex])] - from, to - from);
    if (glm::dot(normal, at[static_cast<std::size_t>(loop[other])] - from) < 0.0) apex = other;
  }
  triangles.push_back({loop[first], loop[apex], loop[last]});
  append_hull(loop, at, first, apex, triangles);
  append_hull(loop, at, apex, last, triangles);
}

/// On a face of a plain cell, polygons around the part of the face that is in A - B but not in W alone,
/// clockwise seen from outside the cell. Numbers 0..11 are A's crossings on the edges of the cell, 12..23
/// B's.
std::vector<std::vector<int>> polygons_between(int face, int from_low, int above_high) {
  constexpr int second = 12;
  std::vector<std::pair<int, int>> lines;
  const auto add = [&](int from, int to) {
    const auto back = std::find(lines.begin(), lines.end(), std::pair(to, from));
    if (back != lines.end())
      lines.erase(back);
    else
      lines.emplace_back(from, to);
  };
  const auto crossed = [](int corners, int edge) {
    const std::array<int, 2> ends = corners_of_edge(edge);
    return ((corners >> ends[0]) & 1) != ((corners >> ends[1]) & 1);
  };
  for (const FaceSegment& s : segments_of_face(face, from_low)) add(s.from, s.to);
  for (const FaceSegment& s : segments_of_face(face, above_high)) add(second + s.to, second + s.from);
  const auto of_window = [&](int edge) { return crossed(from_low, edge) ? edge : second + edge; };
  for (const FaceSegment& s : segments_of_face(face, from_low & ~above_high))
    add(of_window(s.to), of_window(s.from));
  // Along an edge that both levels cross, the polygon runs from one crossing to the other.
  for (const int edge : edges_of_face(face)) {
    if (!crossed(from_low, edge) || !crossed(above_high, edge)) continue;
    const bool low_first =
        std::any_of(lines.begin(), lines.end(), [&](const auto& line) { return line.second == edge; });
    lines.emplace_back(low_first ? edge : second + edge, low_first ? second + edge : edge);
  }
  std::vector<std::vector<int>> polygons;
  while (!lines.empty()) {
    std::vector<int> polygon;
    int at = lines.front().first;
    for (auto next = lines.begin(); next != lines.end();
         next =
             std::find_if(lines.begin(), lines.end(), [&](const auto& line) { return line.first == at; })) {
      polygon.push_back(next->first);
      at = next->second;
      lines.erase(next);
    }
    assert(polygon.size() >= 3 && at == polygon.front());
    polygons.push_back(std::move(polygon));
  }
  return polygons;
}

class WindowSurface {
 public:
  WindowSurface(const voxel::Lattice& lattice, const WindowBits& bits, const Crossings& low,
                const Crossings& high, const voxel::Progress& progress)
      : lattice_(lattice), bits_(bits), numbers_(lattice.dims) {
    const voxel::Lattice of_samples{lattice.dims, glm::dmat4(1.0)};
    low_ = extract_surface(of_samples, bits.from_low, low, voxel::part_of(progress, 0.0, 0.35));
    high_ = extract_surface(of_samples, bits.above_high, high, voxel::part_of(progress, 0.35, 0.7));
    const std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (low_.points_mm.size() + std::uint64_t{high_.points_mm.size()} > most ||
        low_.faces.size() + std::uint64_t{high_.faces.size()} > most)
      throw voxel::Error(
          voxel::ErrorCode::Resource,
          "the surfaces of the window's two bounds have " +
              std::to_string(low_.faces.size() + high_.faces.size()) +
              " triangles together, more than 32-bit numbers can name: crop or resample the scan");
    behind_low_ = static_cast<std::uint32_t>(low_.points_mm.size());
  }

  brep::Triangles run(const voxel::Progress& progress) {
    cells_ = shared_cells(cells_of(low_, numbers_), cells_of(high_, numbers_));
    progress.at(0.8);
    part_plain_cells();
    tbb::parallel_for(std::size_t{0}, cells_.size(), [&](std::size_t i) { replace(cells_[i]); });
    progress.at(0.9);
    brep::Triangles joined = join();
    progress.at(1.0);
    return joined;
  }

 private:
  /// The crossings of a cell by edge: numbers of points, those of B behind those of A, and positions in the cell.
  struct CellCrossings {
    std::array<std::uint32_t, 24> number{};
    std::array<glm::dvec3, 24> at{};
  };

  bool is_plain(const glm::ivec3& cell) const {
    return corners_in(bits_.measured, cell) != 255 || plain_.contains(numbers_.number(cell));
  }

  /// Step 5.
  void part_plain_cells() {
    std::vector<std::uint64_t> open;
    for (const SharedCell& shared : cells_)
      if (is_plain(numbers_.cell(shared.number))) open.push_back(shared.number);
    while (!open.empty()) {
      const glm::ivec3 cell = numbers_.cell(open.back());
      open.pop_back();
      const int above = corners_in(bits_.above_high, cell),
                below = corners_in(bits_.measured, cell) & ~corners_in(bits_.from_low, cell);
      for (int edge = 0; edge < 12; ++edge) {
        const std::array<int, 2> ends = corners_of_edge(edge);
        const int both = (1 << ends[0]) | (1 << ends[1]);
        if ((above & both) == 0 || (below & both) == 0) continue;
        // The four cells around the edge, in order.
        const int axis = edge / 4, b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
        const glm::ivec3 first = cell + corner_offset(ends[0]);
        std::array<glm::ivec3, 4> around{first, first, first, first};
        --around[0][b], --around[0][c], --around[1][c], --around[3][b];
        std::array<bool, 4> plain{};
        for (std::size_t i = 0; i < 4; ++i) plain[i] = is_plain(around[i]);
        if (plain[0] != plain[2] || plain[1] != plain[3] || plain[0] == plain[1]) continue;
        for (std::size_t i = plain[0] ? 1 : 0; i < 4; i += 2) {
          plain_.insert(numbers_.number(around[i]));
          open.push_back(numbers_.number(around[i]));
        }
      }
    }
  }

  CellCrossings crossings_of(const SharedCell& shared) const {
    const glm::dvec3 origin(numbers_.cell(shared.number));
    CellCrossings found;
    const auto add = [&](const brep::Triangles& surface, std::uint32_t point, bool is_high) {
      const glm::dvec3 at = surface.points_mm[point] - origin;
      int axis = 0;
      while (at[axis] == 0.0 || at[axis] == 1.0) ++axis;
      const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
      const auto edge = static_cast<std::size_t>(4 * axis + (at[b] != 0.0 ? 1 : 0) + (at[c] != 0.0 ? 2 : 0) +
                                                 (is_high ? 12 : 0));
      found.number[edge] = point + (is_high ? behind_low_ : 0);
      found.at[edge] = at;
    };
    for (std::size_t i = shared.low_begin; i < shared.low_end; ++i)
      for (const std::uint32_t point : low_.faces[i]) add(low_, point, false);
    for (std::size_t i = shared.high_begin; i < shared.high_end; ++i)
      for (const std::uint32_t point : high_.faces[i]) add(high_, point, true);
    return found;
  }

  void replace(SharedCell& shared) const {
    const glm::ivec3 cell = numbers_.cell(shared.number);
    if (is_plain(cell))
      replace_plain(shared, cell);
    else if (!are_apart(shared))
      replace_high(shared, cell);
  }

  bool are_apart(const SharedCell& shared) const {
    const auto corners = [](const brep::Triangles& surface, std::size_t i) {
      const Face& face = surface.faces[i];
      return std::array<glm::dvec3, 3>{surface.points_mm[face[0]], surface.points_mm[face[1]],
                                       surface.points_mm[face[2]]};
    };
    for (std::size_t i = shared.low_begin; i < shared.low_end; ++i)
      for (std::size_t k = shared.high_begin; k < shared.high_end; ++k) {
        const std::array<glm::dvec3, 3> a = corners(low_, i), b = corners(high_, k);
        if (!separates(a, b) && !separates(b, a)) return false;
      }
    return true;
  }

  /// Step 3.
  void replace_high(SharedCell& shared, const glm::ivec3& cell) const {
    const CellCrossings crossings = crossings_of(shared);
    std::array<glm::dvec3, 12> at{};
    std::copy_n(crossings.at.begin() + 12, 12, at.begin());
    std::vector<std::array<int, 3>> triangles;
    for (const std::vector<int>& loop : marching_cubes_case(corners_in(bits_.above_high, cell)).loops)
      append_hull(loop, at, 0, loop.size() - 1, triangles);
    shared.is_replaced = true;
    for (std::size_t i = shared.low_begin; i < shared.low_end; ++i) shared.triangles.push_back(low_.faces[i]);
    for (const auto& [i, k, m] : triangles)
      shared.triangles.push_back({crossings.number[static_cast<std::size_t>(12 + i)],
                                  crossings.number[static_cast<std::size_t>(12 + m)],
                                  crossings.number[static_cast<std::size_t>(12 + k)]});
  }

  /// Step 4.
  void replace_plain(SharedCell& shared, const glm::ivec3& cell) const {
    const int measured = corners_in(bits_.measured, cell), from_low = corners_in(bits_.from_low, cell),
              above_high = corners_in(bits_.above_high, cell);
    const CellCrossings crossings = crossings_of(shared);
    shared.is_replaced = true;
    for (const std::array<std::uint8_t, 3>& t : marching_cubes_case(from_low & ~above_high).triangles) {
      Face face{};
      for (std::size_t i = 0; i < 3; ++i) {
        const std::array<int, 2> ends = corners_of_edge(t[i]);
        const int both = (1 << ends[0]) | (1 << ends[1]);
        face[i] = crossings.number[t[i] + ((from_low & both) == both ? 12U : 0U)];
      }
      shared.triangles.push_back(face);
    }
    for (int face = 0; face < 6; ++face) {
      const std::array<int, 4> corners = corners_of_face(face);
      if (std::any_of(corners.begin(), corners.end(), [&](int c) { return ((measured >> c) & 1) == 0; }))
        continue;
      glm::ivec3 beyond = cell;
      beyond[face / 2] += face % 2 == 1 ? 1 : -1;
      if (is_plain(beyond)) continue;
      for (const std::vector<int>& polygon : polygons_between(face, from_low, above_high))
        for (std::size_t i = 2; i < polygon.size(); ++i)
          shared.triangles.push_back({crossings.number[static_cast<std::size_t>(polygon[0])],
                                      crossings.number[static_cast<std::size_t>(polygon[i - 1])],
                                      crossings.number[static_cast<std::size_t>(polygon[i])]});
    }
  }

  /// All triangles, and the points that they use.
  brep::Triangles join() {
    brep::Triangles joined;
    std::size_t count = low_.faces.size() + high_.faces.size();
    for (const SharedCell& shared : cells_)
      if (shared.is_replaced)
        count = count + shared.triangles.size() - (shared.low_end - shared.low_begin) -
                (shared.high_end - shared.high_begin);
    joined.faces.resize(count);
    std::size_t low = 0, high = 0;
    Face* at = joined.faces.data();
    const auto copy_to = [&](std::size_t low_end, std::size_t high_end) {
      for_ranges(low_end - low, [&](std::size_t i) { at[i] = low_.faces[low + i]; });
      at += low_end - low;
      for_ranges(high_end - high, [&](std::size_t i) {
        const auto& [a, b, c] = high_.faces[high + i];
        at[i] = {a + behind_low_, c + behind_low_, b + behind_low_};
      });
      at += high_end - high;
    };
    for (const SharedCell& shared : cells_) {
      if (!shared.is_replaced) continue;
      copy_to(shared.low_begin, shared.high_begin);
      low = shared.low_end;
      high = shared.high_end;
      at = std::copy(shared.triangles.begin(), shared.triangles.end(), at);
    }
    copy_to(low_.faces.size(), high_.faces.size());
    assert(at == joined.faces.data() + joined.faces.size());
    number_points(joined);
    return joined;
  }

  /// Calls f(i) for i below `count`, on all threads if that is worth it.
  template <typename F>
  static void for_ranges(std::size_t count, const F& f) {
    constexpr std::size_t grain = 4096;
    if (count <= grain) {
      for (std::size_t i = 0; i < count; ++i) f(i);
      return;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) f(i);
    });
  }

  void number_points(brep::Triangles& joined) const {
    const bool mirrored = !lattice_.right_handed();
    constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(low_.points_mm.size() + high_.points_mm.size(), unused);
    for_ranges(joined.faces.size(), [&](std::size_t i) {
      for (const std::uint32_t point : joined.faces[i])
        std::atomic_ref(number[point]).store(0, std::memory_order_relaxed);
    });
    std::uint32_t count = 0;
    for (std::uint32_t& each : number)
      if (each != unused) each = count++;
    joined.points_mm.resize(count);
    for_ranges(number.size(), [&](std::size_t i) {
      if (number[i] == unused) return;
      joined.points_mm[number[i]] =
          lattice_.lps_mm(i < behind_low_ ? low_.points_mm[i] : high_.points_mm[i - behind_low_]);
    });
    for_ranges(joined.faces.size(), [&](std::size_t i) {
      for (std::uint32_t& point : joined.faces[i]) point = number[point];
      if (mirrored) std::swap(joined.faces[i][1], joined.faces[i][2]);
    });
  }

  const voxel::Lattice& lattice_;
  const WindowBits& bits_;
  CellNumbers numbers_;
  brep::Triangles low_, high_;    ///< of A and B, in coordinates of samples
  std::uint32_t behind_low_ = 0;  ///< the number of the first point of B
  std::vector<SharedCell> cells_;
  std::unordered_set<std::uint64_t> plain_;  ///< cells with all samples measured that became plain in step 5
};

}  // namespace

brep::Triangles window_surface(const voxel::Lattice& lattice, const WindowBits& bits, const Crossings& low,
                               const Crossings& high, const voxel::Progress& progress) {
  return WindowSurface(lattice, bits, low, high, progress).run(progress);
}

}  // namespace octotomy::convert
