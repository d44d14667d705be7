// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/isosurface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>

#include "convert/marching_cubes.h"

// Source: Lorensen and Cline, "Marching cubes", SIGGRAPH 1987; cases from marching_cubes.h. The passes:
//
// 1 A bit a sample says whether it is inside the window. The lattice is padded by one sample that is outside,
//   so that the surface closes at the scan's border. From here on corners are counted in the padded lattice.
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

/// The closest that a crossing may come to a sample, as a part of the edge. Without it, a sample equal to a
/// bound would collapse up to six vertices into one point and triangles to nothing. Half the step that one
/// unit makes on an edge whose ends differ by 512: that is where the rounding of the samples themselves
/// already leaves the crossing of an edge from soft tissue to bone. The bias is second order in it: only that
/// part of the crossings moves, and by that part of an edge at most.
constexpr double closest_to_sample() {
  return 0.5 / 512.0;
}

/// Where the line between two samples leaves the window, from the first sample, as a part of the edge. A
/// sample that is no number is outside; the crossing beside it is half way.
double crossing(double first, double second, bool first_inside, double low, double high) {
  const double outside = first_inside ? second : first;
  const double bound = outside > high ? high : low;
  const double t = (bound - first) / (second - first);
  if (std::isnan(t)) return 0.5;
  return std::clamp(t, closest_to_sample(), 1.0 - closest_to_sample());
}

/// Bits of the padded lattice by rows along x, whole words each, with at least one outside bit at the end.
struct InsideBits {
  explicit InsideBits(const glm::ivec3& dims)
      : rows_y(static_cast<std::size_t>(dims.y) + 2),
        planes_z(static_cast<std::size_t>(dims.z) + 2),
        words(static_cast<std::size_t>(dims.x + 2) / 64 + 1),
        bits(rows_y * planes_z * words, 0) {}

  std::size_t row_number(std::size_t y, std::size_t z) const { return z * rows_y + y; }
  const std::uint64_t* row(std::size_t y, std::size_t z) const { return &bits[row_number(y, z) * words]; }
  std::uint64_t* row(std::size_t y, std::size_t z) { return &bits[row_number(y, z) * words]; }

  std::size_t rows_y, planes_z, words;
  std::vector<std::uint64_t> bits;
};

/// Eight flags of one byte each, the first in the lowest byte, as eight bits.
std::uint64_t packed(std::uint64_t flags) {
  return (flags * 0x0102040810204080ULL) >> 56;
}

/// Sets the bits of one row of samples, one place up for the padding.
template <typename Sample, typename Inside>
void mark_row(const Sample* samples, std::size_t count, const Inside& inside, std::uint64_t* row) {
  std::uint64_t carry = 0;
  for (std::size_t first = 0; first < count; first += 64) {
    std::array<std::uint8_t, 64> flags{};
    if (first + 64 <= count) {
      for (std::size_t i = 0; i < 64; ++i) flags[i] = inside(samples[first + i]) ? 1 : 0;
    } else {
      for (std::size_t i = 0; first + i < count; ++i) flags[i] = inside(samples[first + i]) ? 1 : 0;
    }
    std::uint64_t word = 0;
    for (std::size_t byte = 0; byte < 8; ++byte) {
      std::uint64_t eight = 0;
      for (std::size_t i = 0; i < 8; ++i) eight |= std::uint64_t{flags[8 * byte + i]} << (8 * i);
      word |= packed(eight) << (8 * byte);
    }
    row[first / 64] |= (word << 1) | carry;
    carry = word >> 63;
  }
  if (carry != 0) row[(count - 1) / 64 + 1] |= carry;
}

template <typename Sample, typename Inside>
void mark_all(const voxel::Samples<Sample>& samples, const glm::ivec3& dims, const Inside& inside,
              InsideBits& bits) {
  const auto nx = static_cast<std::size_t>(dims.x);
  const auto ny = static_cast<std::size_t>(dims.y);
  tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(dims.z), [&](std::size_t z) {
    for (std::size_t y = 0; y < ny; ++y)
      mark_row(&samples[(z * ny + y) * nx], nx, inside, bits.row(y + 1, z + 1));
  });
}

void mark(const voxel::Int16Samples& samples, const glm::ivec3& dims, double low, double high,
          InsideBits& bits) {
  const double least = std::max(std::ceil(low), -32768.0);
  const double most = std::min(std::floor(high), 32767.0);
  if (!(least <= most)) return;
  const auto from = static_cast<std::int16_t>(least);
  const auto to = static_cast<std::int16_t>(most);
  mark_all(
      samples, dims, [=](std::int16_t v) { return (v >= from) & (v <= to); }, bits);
}

void mark(const voxel::FloatSamples& samples, const glm::ivec3& dims, double low, double high,
          InsideBits& bits) {
  mark_all(
      samples, dims,
      [=](float v) { return (static_cast<double>(v) >= low) & (static_cast<double>(v) <= high); }, bits);
}

/// Bit x: the samples at x and x + 1 differ.
std::uint64_t crossed_x(const std::uint64_t* row, std::size_t word, std::size_t words) {
  const std::uint64_t next = word + 1 < words ? row[word + 1] : 0;
  return row[word] ^ ((row[word] >> 1) | (next << 63));
}

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
  Extraction(const voxel::Scene& scene, double low, double high)
      : lattice_(scene.lattice),
        low_(low),
        high_(high),
        bits_(scene.lattice.dims),
        cases_(flat_cases(!scene.lattice.right_handed())) {}

  template <typename Sample>
  brep::Triangles run(const voxel::Samples<Sample>& samples) {
    mark(samples, lattice_.dims, low_, high_, bits_);
    count();
    number();
    write(samples);
    return std::move(surface_);
  }

 private:
  /// Calls f(x, case, rows) for each cell of a row that the surface passes.
  template <typename F>
  void for_crossed_cells(std::size_t y, std::size_t z, EdgeRows rows, const F& f) const {
    const std::size_t words = bits_.words;
    const std::array<const std::uint64_t*, 4> row = {bits_.row(y, z), bits_.row(y + 1, z),
                                                     bits_.row(y, z + 1), bits_.row(y + 1, z + 1)};
    for (std::size_t word = 0; word < words; ++word) {
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
    rows_.resize(bits_.rows_y * bits_.planes_z + 1);
    tbb::parallel_for(std::size_t{0}, bits_.planes_z - 1, [&](std::size_t z) {
      for (std::size_t y = 0; y + 1 < bits_.rows_y; ++y) {
        RowCount& row = rows_[bits_.row_number(y, z)];
        const std::uint64_t* here = bits_.row(y, z);
        const std::uint64_t* along_y = bits_.row(y + 1, z);
        const std::uint64_t* along_z = bits_.row(y, z + 1);
        for (std::size_t word = 0; word < bits_.words; ++word) {
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

  /// Turns counts into first numbers; the last entry holds the totals.
  void number() {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    for (RowCount& row : rows_) {
      for (std::uint32_t& direction : row.vertices)
        vertices += std::exchange(direction, static_cast<std::uint32_t>(vertices));
      triangles += std::exchange(row.triangles, static_cast<std::uint32_t>(triangles));
    }
    if (std::max(vertices, triangles) > std::numeric_limits<std::uint32_t>::max())
      throw std::length_error("the isosurface would have " + std::to_string(vertices) + " vertices and " +
                              std::to_string(triangles) +
                              " triangles, more than 32-bit numbers can name: crop or resample the scan");
    surface_.points_mm.resize(vertices);
    surface_.faces.resize(triangles);
  }

  template <typename Sample>
  void write(const voxel::Samples<Sample>& samples) {
    tbb::parallel_for(std::size_t{0}, bits_.planes_z - 1, [&](std::size_t z) {
      for (std::size_t y = 0; y + 1 < bits_.rows_y; ++y) {
        write_vertices(samples, y, z);
        write_triangles(y, z);
      }
    });
  }

  template <typename Sample>
  void write_vertices(const voxel::Samples<Sample>& samples, std::size_t y, std::size_t z) {
    const std::uint64_t* here = bits_.row(y, z);
    const std::array<const std::uint64_t*, 3> beyond = {nullptr, bits_.row(y + 1, z), bits_.row(y, z + 1)};
    const RowCount& row = rows_[bits_.row_number(y, z)];
    for (int axis = 0; axis < 3; ++axis) {
      std::uint32_t vertex = row.vertices[axis];
      for (std::size_t word = 0; word < bits_.words; ++word) {
        const std::uint64_t crossed =
            axis == 0 ? crossed_x(here, word, bits_.words) : here[word] ^ beyond[axis][word];
        for (std::uint64_t left = crossed; left != 0; left &= left - 1) {
          const int bit = std::countr_zero(left);
          const glm::ivec3 padded(static_cast<int>(64 * word) + bit, static_cast<int>(y),
                                  static_cast<int>(z));
          const bool inside = ((here[word] >> bit) & 1) != 0;
          surface_.points_mm[vertex++] = vertex_mm(samples, padded - 1, axis, inside);
        }
      }
    }
  }

  template <typename Sample>
  glm::dvec3 vertex_mm(const voxel::Samples<Sample>& samples, const glm::ivec3& voxel, int axis,
                       bool inside) const {
    const glm::ivec3& dims = lattice_.dims;
    glm::dvec3 p_voxel(voxel);
    // Beyond the scan there is no sample to interpolate with: the voxel ends half way.
    if (voxel[axis] < 0 || voxel[axis] + 1 >= dims[axis]) {
      p_voxel[axis] += 0.5;
    } else {
      const auto nx = static_cast<std::size_t>(dims.x);
      const auto ny = static_cast<std::size_t>(dims.y);
      const std::array<std::size_t, 3> step = {1, nx, nx * ny};
      const std::size_t index = static_cast<std::size_t>(voxel.x) + nx * static_cast<std::size_t>(voxel.y) +
                                nx * ny * static_cast<std::size_t>(voxel.z);
      p_voxel[axis] += crossing(static_cast<double>(samples[index]),
                                static_cast<double>(samples[index + step[static_cast<std::size_t>(axis)]]),
                                inside, low_, high_);
    }
    return lattice_.lps_mm(p_voxel);
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
  double low_, high_;
  InsideBits bits_;
  std::array<FlatCase, 256> cases_;
  std::vector<RowCount> rows_;
  brep::Triangles surface_;
};

}  // namespace

brep::Triangles isosurface(const voxel::Scene& scene, double low, double high) {
  check(scene);
  if (std::isnan(low) || std::isnan(high))
    throw std::invalid_argument("isosurface: a bound of the window is not a number");
  Extraction extraction(scene, low, high);
  return std::visit([&](const auto& samples) { return extraction.run(samples); }, scene.samples);
}

}  // namespace octotomy::convert
