// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface_extraction.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <utility>

#include "convert/marching_cubes.h"
#include "voxel/slice_bits.h"

// Source: Lorensen and Cline, "Marching cubes", SIGGRAPH 1987; cases from marching_cubes.h. The passes:
//
// 1 A bit a sample says whether it is inside. The lattice is padded by samples that are outside, so that the
//   surface closes at its border. From here on corners are counted in the padded lattice.
// 2 Every row of cells counts its crossings and triangles. Word operations find both: an edge is crossed
//   where two neighbouring bits differ.
// 3 A running sum over the rows gives every row its first vertex and its first triangle, so the numbers do
//   not depend on who computes what.
// 4 Every row writes its vertices, then its triangles. A vertex's number is its row's first plus the crossed
//   edges before it, which a population count gives: no table of vertices is kept.
//
// Memory beside the surface: one bit a sample and 16 bytes a row of samples.

namespace octotomy::convert {
namespace {

/// Bit x: the samples at x and x + 1 differ.
std::uint64_t crossed_x(const std::uint64_t* row, std::size_t word, std::size_t words) {
  const std::uint64_t next = word + 1 < words ? row[word + 1] : 0;
  return row[word] ^ ((row[word] >> 1) | (next << 63));
}

/// Words of a row, or of rows beside each other, that hold a crossed edge: those with a bit, and the one
/// before them, whose last edge ends in the first of them.
struct Words {
  std::uint32_t begin = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t end = 0;
  Words& operator|=(const Words& other) {
    begin = std::min(begin, other.begin);
    end = std::max(end, other.end);
    return *this;
  }
};

/// Crossed edges of a row by direction, and triangles of the row of cells that begins at it.
struct RowCount {
  std::array<std::uint32_t, 3> vertices{};
  std::uint32_t triangles = 0;
};

/// A case's triangles in a form that the inner loop reads.
struct FlatCase {
  std::uint32_t count = 0;
  std::array<std::array<std::uint8_t, 3>, 5> triangles{};
};

std::array<FlatCase, 256> flat_cases(bool mirrored) {
  std::array<FlatCase, 256> flat;
  for (int inside = 0; inside < 256; ++inside) {
    FlatCase& target = flat[static_cast<std::size_t>(inside)];
    for (const std::array<std::uint8_t, 3>& t : marching_cubes_case(inside).triangles)
      target.triangles.at(target.count++) = mirrored ? std::array<std::uint8_t, 3>{t[0], t[2], t[1]} : t;
  }
  return flat;
}

/// The twelve edges' place in a row of cells: the bits of eight rows of edges, along x at (y, z) = (0, 0),
/// (1, 0), (0, 1), (1, 1), along y at z = 0, 1, along z at y = 0, 1. Edges along y and z serve two cells.
struct EdgeRows {
  std::array<std::uint64_t, 8> crossed{};
  std::array<std::uint32_t, 8> first{};  ///< number of the first vertex of the word
};

class Extraction {
 public:
  Extraction(const voxel::Lattice& lattice, const InsideBits& bits, const Crossing& crossing)
      : lattice_(lattice), bits_(bits), crossing_(crossing), cases_(flat_cases(!lattice.right_handed())) {
    for (int column = 0; column < 4; ++column)
      columns_mm_[static_cast<std::size_t>(column)] = glm::dvec3(lattice.lps_from_voxel[column]);
  }

  brep::Triangles run() {
    find_words();
    count();
    number();
    write();
    return std::move(surface_);
  }

 private:
  void find_words() {
    tbb::parallel_invoke([&] { words_.resize(bits_.rows_y * bits_.planes_z); },
                         [&] { rows_.resize(bits_.rows_y * bits_.planes_z); });
    tbb::parallel_for(std::size_t{0}, bits_.planes_z, [&](std::size_t z) {
      for (std::size_t y = 0; y < bits_.rows_y; ++y) {
        const std::uint64_t* row = bits_.row(y, z);
        std::size_t begin = 0;
        while (begin < bits_.words && row[begin] == 0) ++begin;
        if (begin == bits_.words) continue;
        std::size_t end = bits_.words;
        while (row[end - 1] == 0) --end;
        words_[bits_.row_number(y, z)] = {static_cast<std::uint32_t>(begin > 0 ? begin - 1 : 0),
                                          static_cast<std::uint32_t>(end)};
      }
    });
  }

  /// Of the cells between four rows.
  Words words_of_cells(std::size_t y, std::size_t z) const {
    Words words = words_[bits_.row_number(y, z)];
    words |= words_[bits_.row_number(y + 1, z)];
    words |= words_[bits_.row_number(y, z + 1)];
    words |= words_[bits_.row_number(y + 1, z + 1)];
    return words;
  }

  /// Calls f(x, case, rows) for each cell of a row that the surface passes.
  template <typename F>
  void for_crossed_cells(std::size_t y, std::size_t z, EdgeRows rows, const F& f) const {
    const Words within = words_of_cells(y, z);
    const std::size_t words = bits_.words;
    const std::array<const std::uint64_t*, 4> row = {bits_.row(y, z), bits_.row(y + 1, z),
                                                     bits_.row(y, z + 1), bits_.row(y + 1, z + 1)};
    for (std::size_t word = within.begin; word < within.end; ++word) {
      std::array<std::uint64_t, 4> here{};
      for (std::size_t i = 0; i < 4; ++i) {
        here[i] = row[i][word];
        rows.crossed[i] = crossed_x(row[i], word, words);
      }
      rows.crossed[4] = here[0] ^ here[1];
      rows.crossed[5] = here[2] ^ here[3];
      rows.crossed[6] = here[0] ^ here[2];
      rows.crossed[7] = here[1] ^ here[3];
      std::uint64_t any = 0;
      for (const std::uint64_t crossed : rows.crossed) any |= crossed;
      // Where no edge at x is crossed, all eight corners are equal: the far edges need no look.
      for (std::uint64_t left = any; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        std::uint32_t inside = 0;
        for (std::uint32_t i = 0; i < 4; ++i) {
          const std::uint32_t at_x = (here[i] >> bit) & 1;
          const std::uint32_t crossed = (rows.crossed[i] >> bit) & 1;
          inside |= (at_x | ((at_x ^ crossed) << 1)) << (2 * i);
        }
        f(64 * word + static_cast<std::size_t>(bit), bit, inside, rows);
      }
      if (any != 0)
        for (std::size_t i = 0; i < 8; ++i)
          rows.first[i] += static_cast<std::uint32_t>(std::popcount(rows.crossed[i]));
    }
  }

  void count() {
    tbb::parallel_for(std::size_t{0}, bits_.planes_z - 1, [&](std::size_t z) {
      for (std::size_t y = 0; y + 1 < bits_.rows_y; ++y) {
        RowCount& row = rows_[bits_.row_number(y, z)];
        const std::uint64_t* here = bits_.row(y, z);
        const std::uint64_t* along_y = bits_.row(y + 1, z);
        const std::uint64_t* along_z = bits_.row(y, z + 1);
        const Words within = words_of_cells(y, z);
        for (std::size_t word = within.begin; word < within.end; ++word) {
          const std::array<std::uint64_t, 3> crossed = {
              crossed_x(here, word, bits_.words), here[word] ^ along_y[word], here[word] ^ along_z[word]};
          for (std::size_t axis = 0; axis < 3; ++axis)
            if (crossed[axis] != 0)
              row.vertices[axis] += static_cast<std::uint32_t>(std::popcount(crossed[axis]));
        }
        for_crossed_cells(y, z, {}, [&](std::size_t, int, std::uint32_t inside, const EdgeRows&) {
          row.triangles += cases_[inside].count;
        });
      }
    });
  }

  struct Totals {
    std::uint64_t vertices = 0, triangles = 0;
  };

  /// Turns counts into first numbers: sums of planes, then what comes before each, then before each row.
  void number() {
    std::vector<Totals> before(bits_.planes_z + 1);
    tbb::parallel_for(std::size_t{0}, bits_.planes_z, [&](std::size_t z) {
      for (std::size_t y = 0; y < bits_.rows_y; ++y) {
        const RowCount& row = rows_[bits_.row_number(y, z)];
        for (const std::uint32_t direction : row.vertices) before[z + 1].vertices += direction;
        before[z + 1].triangles += row.triangles;
      }
    });
    for (std::size_t z = 1; z < before.size(); ++z) {
      before[z].vertices += before[z - 1].vertices;
      before[z].triangles += before[z - 1].triangles;
    }
    const Totals all = before.back();
    if (std::max(all.vertices, all.triangles) > std::numeric_limits<std::uint32_t>::max())
      throw std::length_error("the isosurface would have " + std::to_string(all.vertices) + " vertices and " +
                              std::to_string(all.triangles) +
                              " triangles, more than 32-bit numbers can name: crop or resample the scan");
    tbb::parallel_for(std::size_t{0}, bits_.planes_z, [&](std::size_t z) {
      auto vertex = static_cast<std::uint32_t>(before[z].vertices);
      auto triangle = static_cast<std::uint32_t>(before[z].triangles);
      for (std::size_t y = 0; y < bits_.rows_y; ++y) {
        RowCount& row = rows_[bits_.row_number(y, z)];
        for (std::uint32_t& direction : row.vertices) vertex += std::exchange(direction, vertex);
        triangle += std::exchange(row.triangles, triangle);
      }
    });
    // New pages are half of what this costs.
    tbb::parallel_invoke([&] { surface_.points_mm.resize(all.vertices); },
                         [&] { surface_.faces.resize(all.triangles); });
  }

  void write() {
    tbb::parallel_for(std::size_t{0}, bits_.planes_z - 1, [&](std::size_t z) {
      for (std::size_t y = 0; y + 1 < bits_.rows_y; ++y) {
        write_vertices(y, z);
        write_triangles(y, z);
      }
    });
  }

  void write_vertices(std::size_t y, std::size_t z) {
    const std::uint64_t* here = bits_.row(y, z);
    const std::array<const std::uint64_t*, 3> beyond = {nullptr, bits_.row(y + 1, z), bits_.row(y, z + 1)};
    const RowCount& row = rows_[bits_.row_number(y, z)];
    const Words within = words_of_cells(y, z);
    for (int axis = 0; axis < 3; ++axis) {
      std::uint32_t vertex = row.vertices[axis];
      for (std::size_t word = within.begin; word < within.end; ++word) {
        const std::uint64_t crossed =
            axis == 0 ? crossed_x(here, word, bits_.words) : here[word] ^ beyond[axis][word];
        for (std::uint64_t left = crossed; left != 0; left &= left - 1) {
          const int bit = std::countr_zero(left);
          const glm::ivec3 padded(static_cast<int>(64 * word) + bit, static_cast<int>(y),
                                  static_cast<int>(z));
          const bool inside = ((here[word] >> bit) & 1) != 0;
          surface_.points_mm[vertex++] = vertex_mm(padded - bits_.padding, axis, inside);
        }
      }
    }
  }

  glm::dvec3 vertex_mm(const glm::ivec3& voxel, int axis, bool inside) const {
    glm::dvec3 p_voxel(voxel);
    // Beyond the scan there is no sample to interpolate with: the voxel ends half way.
    if (voxel[axis] < 0 || voxel[axis] + 1 >= lattice_.dims[axis]) {
      p_voxel[axis] += 0.5;
    } else {
      p_voxel[axis] += crossing_(voxel, axis, inside);
    }
    // As Lattice::lps_mm() does, to the last bit.
    return (columns_mm_[0] * p_voxel.x + columns_mm_[1] * p_voxel.y) +
           (columns_mm_[2] * p_voxel.z + columns_mm_[3]);
  }

  void write_triangles(std::size_t y, std::size_t z) {
    const std::array<const RowCount*, 4> row = {
        &rows_[bits_.row_number(y, z)], &rows_[bits_.row_number(y + 1, z)],
        &rows_[bits_.row_number(y, z + 1)], &rows_[bits_.row_number(y + 1, z + 1)]};
    EdgeRows first;
    for (std::size_t i = 0; i < 4; ++i) first.first[i] = row[i]->vertices[0];
    first.first[4] = row[0]->vertices[1];
    first.first[5] = row[2]->vertices[1];
    first.first[6] = row[0]->vertices[2];
    first.first[7] = row[1]->vertices[2];
    std::uint32_t triangle = row[0]->triangles;
    for_crossed_cells(y, z, first, [&](std::size_t, int bit, std::uint32_t inside, const EdgeRows& rows) {
      const FlatCase& cell = cases_[inside];
      if (cell.count == 0) return;
      const std::uint64_t before = (std::uint64_t{1} << bit) - 1;
      std::array<std::uint32_t, 12> vertex{};
      for (std::size_t i = 0; i < 8; ++i) {
        const std::uint32_t number =
            rows.first[i] + static_cast<std::uint32_t>(std::popcount(rows.crossed[i] & before));
        if (i < 4) {
          vertex[i] = number;
        } else {
          vertex[2 * i - 4] = number;
          vertex[2 * i - 3] = number + static_cast<std::uint32_t>((rows.crossed[i] >> bit) & 1);
        }
      }
      for (std::uint32_t t = 0; t < cell.count; ++t) {
        const std::array<std::uint8_t, 3>& edges = cell.triangles[t];
        surface_.faces[triangle++] = {vertex[edges[0]], vertex[edges[1]], vertex[edges[2]]};
      }
    });
  }

  const voxel::Lattice& lattice_;
  std::array<glm::dvec3, 4> columns_mm_;
  const InsideBits& bits_;
  const Crossing& crossing_;
  std::array<FlatCase, 256> cases_;
  std::vector<Words> words_;
  std::vector<RowCount> rows_;
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
                                const Crossing& crossing) {
  return Extraction(lattice, inside, crossing).run();
}

}  // namespace octotomy::convert
