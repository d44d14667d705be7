// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/surface_extraction.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <limits>
#include <string>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <utility>

#include "convert/surface/marching_cubes.h"
#include "voxel/space/shared_progress.h"
#include "voxel/tree/slice_bits.h"

// Source: Lorensen and Cline, "Marching cubes", SIGGRAPH 1987; cases from marching_cubes.h. The passes:
//
// 1 One bit for each sample states whether the sample is inside. The lattice is padded by samples that are
//   outside, so that the surface closes at its border. From here on corners are counted in the padded
//   lattice.
// 2 Every row of cells counts its crossings and notes the cases of its cells. Word operations find both: an
//   edge is crossed where two neighbouring bits differ.
// 3 A running sum over the rows gives every row its first vertex and every plane its first triangle, so the
// numbers do not depend on which thread computes which row. 4 Every plane writes its vertices, then its
// triangles. A cell's vertices are numbered by running numbers of
//   the eight rows of edges about its row, which advance as the cell's case states: no table of vertices is
//   kept.
//
// Memory beside the surface: one bit a sample, 24 bytes a row of samples and a byte a cell of the surface.

namespace octotomy::convert {
namespace {

/// Bit x: the samples at x and x + 1 differ.
std::uint64_t crossed_x(const std::uint64_t* row, std::size_t word, std::size_t words) {
  const std::uint64_t next = word + 1 < words ? row[word + 1] : 0;
  return row[word] ^ ((row[word] >> 1) | (next << 63));
}

// Arrays over all rows of the lattice take many megabytes, so they are not initialised before threads fill
// them.

/// The words of a row, or of neighbouring rows, that may hold a crossed edge: the words with a bit, and the
/// word before the first of them, because that word's last edge ends in it.
struct Words {
  std::uint32_t begin, end;
};
constexpr Words no_words{std::numeric_limits<std::uint32_t>::max(), 0};
Words both(const Words& a, const Words& b) {
  return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

/// Counts of a row, which number() replaces by first numbers: crossed edges by direction. Also the number of
/// cells with a crossed edge in the row of cells that begins here.
struct RowCount {
  std::array<std::uint32_t, 3> vertices;
  std::uint32_t cells;
};

/// A case of marching cubes, for cells in a row along x. Edges 0 to 3 of a cell are its edges along x, at (y,
/// z) = (0, 0), (1, 0), (0, 1), (1, 1). Edges 4 to 7 are the other edges at its lower x: along y at z = 0, 1,
/// then along z at y = 0, 1. Edges 8 to 11 are the same at its upper x; the next cell has them as 4 to 7.
struct FlatCase {
  std::array<std::uint32_t, 8> crossed{};  ///< 1 if this edge of the cell is crossed
  std::uint32_t count = 0;
  std::array<std::array<std::uint8_t, 3>, 5> triangles{};
};

/// Converts from the edge numbers of marching_cubes.h.
std::uint8_t edge_in_row(std::uint8_t edge) {
  if (edge < 4) return edge;
  return static_cast<std::uint8_t>((edge % 2 == 0 ? 4 : 8) + (edge - 4) / 2);
}

std::array<FlatCase, 256> flat_cases(bool mirrored) {
  std::array<FlatCase, 256> flat;
  for (int inside = 0; inside < 256; ++inside) {
    const MarchingCubesCase& source = marching_cubes_case(inside);
    FlatCase& target = flat[static_cast<std::size_t>(inside)];
    for (std::uint8_t edge = 0; edge < 12; ++edge)
      if (const std::uint8_t row = edge_in_row(edge); row < 8)
        target.crossed[row] = (source.crossed >> edge) & 1;
    for (const std::array<std::uint8_t, 3>& t : source.triangles) {
      std::array<std::uint8_t, 3>& corners = target.triangles.at(target.count++);
      for (std::size_t i = 0; i < 3; ++i) corners[i] = edge_in_row(t[mirrored ? (3 - i) % 3 : i]);
    }
  }
  return flat;
}

class Extraction {
 public:
  Extraction(const voxel::Lattice& lattice, const InsideBits& bits, const Crossings& crossings)
      : lattice_(lattice), bits_(bits), crossings_(crossings), cases_(flat_cases(!lattice.right_handed())) {
    for (int column = 0; column < 4; ++column)
      columns_mm_[static_cast<std::size_t>(column)] = glm::dvec3(lattice.lps_from_voxel[column]);
  }

  brep::Triangles run(const voxel::Progress& progress) {
    progress.at(0.0);
    find_words();
    count(voxel::part_of(progress, 0.0, 0.3));
    number();
    write(voxel::part_of(progress, 0.3, 1.0));
    return std::move(surface_);
  }

 private:
  void find_words() {
    words_.resize(bits_.rows_y * bits_.planes_z);
    rows_.resize(bits_.rows_y * bits_.planes_z);
    planes_.resize(bits_.planes_z);
    tbb::parallel_for(std::size_t{0}, bits_.planes_z, [&](std::size_t z) {
      Plane& plane = planes_[z];
      for (std::size_t y = 0; y < bits_.rows_y; ++y) {
        const std::uint64_t* row = bits_.row(y, z);
        std::uint64_t any = 0;
        for (std::size_t word = 0; word < bits_.words; ++word) any |= row[word];
        words_[bits_.row_number(y, z)] = any != 0 ? words_of(row) : no_words;
        rows_[bits_.row_number(y, z)] = RowCount{};
        if (any == 0) continue;
        if (plane.first_y == plane.end_y) plane.first_y = y;
        plane.end_y = y + 1;
      }
    });
  }

  Words words_of(const std::uint64_t* row) const {
    std::uint32_t begin = 0, end = static_cast<std::uint32_t>(bits_.words);
    while (row[begin] == 0) ++begin;
    while (row[end - 1] == 0) --end;
    return {begin > 0 ? begin - 1 : 0, end};
  }

  /// Calls f(y) for the rows of cells above a plane that have a sample inside. The first and last row and
  /// plane of samples have none.
  template <typename F>
  void for_rows_of_cells(std::size_t z, const F& f) const {
    const Plane &below = planes_[z], &above = planes_[z + 1];
    if (below.end_y == 0 && above.end_y == 0) return;
    const std::size_t first = below.end_y == 0   ? above.first_y
                              : above.end_y == 0 ? below.first_y
                                                 : std::min(below.first_y, above.first_y);
    for (std::size_t y = first - 1; y < std::max(below.end_y, above.end_y); ++y) f(y);
  }

  /// The words of the cells between four rows.
  Words words_of_cells(std::size_t y, std::size_t z) const {
    return both(both(words_[bits_.row_number(y, z)], words_[bits_.row_number(y + 1, z)]),
                both(words_[bits_.row_number(y, z + 1)], words_[bits_.row_number(y + 1, z + 1)]));
  }

  void count(const voxel::Progress& progress) {
    voxel::SharedProgress planes_done(progress, bits_.planes_z - 1);
    tbb::parallel_for(std::size_t{0}, bits_.planes_z - 1, [&](std::size_t z) {
      planes_done.one_more();
      for_rows_of_cells(
          z, [&](std::size_t y) { rows_[bits_.row_number(y, z)] = counted_row(y, z, words_of_cells(y, z)); });
    });
  }

  RowCount counted_row(std::size_t y, std::size_t z, const Words& within) {
    Plane& plane = planes_[z];
    const std::array<const std::uint64_t*, 4> row = {bits_.row(y, z), bits_.row(y + 1, z),
                                                     bits_.row(y, z + 1), bits_.row(y + 1, z + 1)};
    const std::size_t before = plane.cells;
    std::array<std::uint32_t, 3> vertices{};
    std::uint64_t triangles = 0;
    for (std::size_t word = within.begin; word < within.end; ++word) {
      std::array<std::uint64_t, 4> here{}, crossed{};
      for (std::size_t i = 0; i < 4; ++i) {
        here[i] = row[i][word];
        crossed[i] = crossed_x(row[i], word, bits_.words);
      }
      const std::uint64_t along_y = here[0] ^ here[1], along_z = here[0] ^ here[2];
      // If no edge along x and no edge at the lower x is crossed, all eight corners are equal, so no edge at
      // the upper x is crossed either.
      const std::uint64_t any = crossed[0] | crossed[1] | crossed[2] | crossed[3] | along_y | along_z |
                                (here[2] ^ here[3]) | (here[1] ^ here[3]);
      if (any == 0) continue;
      vertices[0] += static_cast<std::uint32_t>(std::popcount(crossed[0]));
      vertices[1] += static_cast<std::uint32_t>(std::popcount(along_y));
      vertices[2] += static_cast<std::uint32_t>(std::popcount(along_z));
      if (plane.cases.size() < plane.cells + 64) plane.cases.resize(2 * plane.cells + 1024);
      std::uint8_t* cell = &plane.cases[plane.cells];
      for (std::uint64_t left = any; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        std::uint64_t inside = 0;
        for (std::size_t i = 0; i < 4; ++i) {
          const std::uint64_t at_x = (here[i] >> bit) & 1, next = at_x ^ ((crossed[i] >> bit) & 1);
          inside |= (at_x | (next << 1)) << (2 * i);
        }
        *cell++ = static_cast<std::uint8_t>(inside);
        triangles += cases_[inside].count;
      }
      plane.cells += static_cast<std::size_t>(std::popcount(any));
    }
    plane.vertices += std::uint64_t{vertices[0]} + vertices[1] + vertices[2];
    plane.triangles += triangles;
    return {vertices, static_cast<std::uint32_t>(plane.cells - before)};
  }

  /// Replaces counts by first numbers, of planes and then of their rows.
  void number() {
    std::uint64_t vertices = 0, triangles = 0;
    for (Plane& plane : planes_) {
      vertices += std::exchange(plane.vertices, vertices);
      triangles += std::exchange(plane.triangles, triangles);
    }
    if (std::max(vertices, triangles) > std::numeric_limits<std::uint32_t>::max())
      throw voxel::Error(voxel::ErrorCode::Resource,
                         "the isosurface would have " + std::to_string(vertices) + " vertices and " +
                             std::to_string(triangles) +
                             " triangles, more than 32-bit numbers can name: crop or resample the scan");
    tbb::parallel_for(std::size_t{0}, bits_.planes_z - 1, [&](std::size_t z) {
      auto vertex = static_cast<std::uint32_t>(planes_[z].vertices);
      for_rows_of_cells(z, [&](std::size_t y) {
        for (std::uint32_t& direction : rows_[bits_.row_number(y, z)].vertices)
          vertex += std::exchange(direction, vertex);
      });
    });
    // In parallel, because touching the new memory is half of the cost here.
    tbb::parallel_invoke([&] { surface_.points_mm.resize(vertices); },
                         [&] { surface_.faces.resize(triangles); });
  }

  void write(const voxel::Progress& progress) {
    voxel::SharedProgress planes_done(progress, bits_.planes_z - 1);
    tbb::parallel_for(std::size_t{0}, bits_.planes_z - 1, [&](std::size_t z) {
      planes_done.one_more();
      write_vertices(z);
      write_triangles(z);
    });
  }

  void write_vertices(std::size_t z) {
    assert(planes_[z].vertices <= planes_[z + 1].vertices);
    const std::vector<CrossedEdge> edges = edges_of(z);
    std::vector<double> parts(edges.size(), 0.5);
    const auto leaves = [&](const CrossedEdge& edge) {
      return edge.voxel[edge.axis] < 0 || edge.voxel[edge.axis] + 1 >= lattice_.dims[edge.axis];
    };
    // An edge that leaves the lattice has no second sample. It is crossed half way, where the voxel ends.
    for (std::size_t i = 0; i < edges.size();) {
      const std::size_t first = i;
      while (i < edges.size() && !leaves(edges[i])) ++i;
      if (first < i) crossings_({&edges[first], i - first}, &parts[first]);
      assert(std::all_of(parts.begin() + static_cast<std::ptrdiff_t>(first),
                         parts.begin() + static_cast<std::ptrdiff_t>(i),
                         [](double part) { return part > 0.0 && part < 1.0; }));
      while (i < edges.size() && leaves(edges[i])) ++i;
    }
    const std::array<glm::dvec3, 3> unit = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    glm::dvec3* point_mm = surface_.points_mm.data() + planes_[z].vertices;
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const glm::dvec3 p_voxel = glm::dvec3(edges[i].voxel) + parts[i] * unit[edges[i].axis];
      // Uses the operations of Lattice::lps_mm() in the same order, so that the last bit agrees.
      *point_mm++ = (columns_mm_[0] * p_voxel.x + columns_mm_[1] * p_voxel.y) +
                    (columns_mm_[2] * p_voxel.z + columns_mm_[3]);
    }
  }

  /// The crossed edges that begin in a plane of samples, in the order of their vertices.
  std::vector<CrossedEdge> edges_of(std::size_t z) const {
    std::vector<CrossedEdge> edges(planes_[z + 1].vertices - planes_[z].vertices);
    CrossedEdge* edge = edges.data();
    for_rows_of_cells(z, [&](std::size_t y) {
      if (rows_[bits_.row_number(y, z)].cells == 0) return;
      const Words within = words_of_cells(y, z);
      const std::uint64_t* here = bits_.row(y, z);
      const std::array<const std::uint64_t*, 3> beyond = {nullptr, bits_.row(y + 1, z), bits_.row(y, z + 1)};
      const glm::ivec3 row = glm::ivec3(0, y, z) - bits_.padding;
      for (std::uint8_t axis = 0; axis < 3; ++axis)
        for (std::size_t word = within.begin; word < within.end; ++word) {
          const std::uint64_t inside = here[word];
          const std::uint64_t crossed =
              axis == 0 ? crossed_x(here, word, bits_.words) : inside ^ beyond[axis][word];
          const int first_x = static_cast<int>(64 * word) + row.x;
          for (std::uint64_t left = crossed; left != 0; left &= left - 1) {
            const int bit = std::countr_zero(left);
            *edge++ = {{first_x + bit, row.y, row.z}, axis, ((inside >> bit) & 1) != 0};
          }
        }
    });
    return edges;
  }

  void write_triangles(std::size_t z) {
    const Plane& plane = planes_[z];
    const std::uint8_t* cell = plane.cases.data();
    std::array<std::uint32_t, 3>* triangle = surface_.faces.data() + plane.triangles;
    for_rows_of_cells(z, [&](std::size_t y) {
      const RowCount& near = rows_[bits_.row_number(y, z)];
      if (near.cells == 0) return;
      const RowCount& beside = rows_[bits_.row_number(y + 1, z)];
      const RowCount& above = rows_[bits_.row_number(y, z + 1)];
      const RowCount& across = rows_[bits_.row_number(y + 1, z + 1)];
      std::array<std::uint32_t, 8> next = {near.vertices[0],   beside.vertices[0], above.vertices[0],
                                           across.vertices[0], near.vertices[1],   above.vertices[1],
                                           near.vertices[2],   beside.vertices[2]};
      assert(cell + near.cells <= plane.cases.data() + plane.cells);
      for (const std::uint8_t* const end = cell + near.cells; cell != end; ++cell) {
        const FlatCase& here = cases_[*cell];
        std::array<std::uint32_t, 12> vertex;  // NOLINT(cppcoreguidelines-pro-type-member-init): set below
        for (std::size_t i = 0; i < 8; ++i) vertex[i] = next[i];
        for (std::size_t i = 0; i < 8; ++i) next[i] += here.crossed[i];
        for (std::size_t i = 4; i < 8; ++i) vertex[4 + i] = next[i];
        for (std::uint32_t t = 0; t < here.count; ++t) {
          const std::array<std::uint8_t, 3>& edges = here.triangles[t];
          *triangle++ = {vertex[edges[0]], vertex[edges[1]], vertex[edges[2]]};
        }
      }
    });
  }

  /// A plane of samples, and of the cells and edges between it and the next.
  struct Plane {
    std::size_t first_y = 0, end_y = 0;         ///< rows with a sample inside
    std::uint64_t vertices = 0, triangles = 0;  ///< counts, then first numbers
    std::vector<std::uint8_t> cases;            ///< cases of the `cells` cells
    std::size_t cells = 0;
  };

  const voxel::Lattice& lattice_;
  std::array<glm::dvec3, 4> columns_mm_;
  const InsideBits& bits_;
  const Crossings& crossings_;
  std::array<FlatCase, 256> cases_;
  std::vector<Words, voxel::LargeAllocator<Words>> words_;
  std::vector<RowCount, voxel::LargeAllocator<RowCount>> rows_;
  std::vector<Plane> planes_;
  brep::Triangles surface_;
};

}  // namespace

InsideBits inside_bits(const voxel::Octree& octree) {
  const int side = octree.universe().side();
  InsideBits bits(glm::ivec3(side), 64);
  tbb::parallel_for(0, side, [&](int z) {
    voxel::SliceBits slice;
    voxel::read_slice(octree, z, slice);
    for (int y = 0; y < side; ++y)
      std::copy_n(slice.row(y), slice.words_per_row,
                  bits.row(static_cast<std::size_t>(y + 1), static_cast<std::size_t>(z + 1)) + 1);
  });
  return bits;
}

brep::Triangles extract_surface(const voxel::Lattice& lattice, const InsideBits& inside,
                                const Crossings& crossings, const voxel::Progress& progress) {
  return Extraction(lattice, inside, crossings).run(progress);
}

}  // namespace octotomy::convert
