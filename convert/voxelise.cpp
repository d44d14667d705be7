// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/voxelise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <utility>

#include "voxel/build.h"
#include "voxel/octree_node.h"

// Parity along rays, with rows of voxels as rays. The passes:
//
// 1 Points to index space, where voxel centres are integers; triangles into slabs of 16 voxel layers.
// 2 A slab's triangles are scanned: every layer z cuts a triangle in at most one segment, every row y cuts
//   the segment in at most one point, and the row's bit at the first voxel not before that point flips.
// 3 A running exclusive-or along each row turns flips into voxels inside.
// 4 A slab's rows become 16 x 16 x 16 blocks.
//
// The half-open rule: an edge is cut by the layer z where one end is at or below z and the other above; a
// segment by the row y where it begins at or below y and ends above. Where a layer cuts an edge is computed
// from its ends in an order that the two triangles on it agree on, so they see the same number to the last
// bit, and each row is crossed an even number of times however its crossings round. So a closed mesh never
// leaks, with vertices and edges on voxel centres too.

namespace octotomy::convert {
namespace {

constexpr int block_side = 16;

/// Index space of a universe from LPS millimetres.
class VoxelFromLps {
 public:
  explicit VoxelFromLps(const voxel::Universe& universe)
      : voxel_from_lps_(glm::inverse(glm::dmat3(universe.lps_from_voxel))),
        first_mm_(universe.lps_from_voxel[3]) {}
  glm::dvec3 operator()(const glm::dvec3& p_mm) const { return voxel_from_lps_ * (p_mm - first_mm_); }

 private:
  glm::dmat3 voxel_from_lps_;
  glm::dvec3 first_mm_;
};

using Corners = std::array<glm::dvec3, 3>;

/// The first integer not below v, within low..high.
int first_not_below(double v, int low, int high) {
  return static_cast<int>(std::clamp(std::ceil(v), static_cast<double>(low), static_cast<double>(high)));
}

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("voxelise: " + why);
}

void check_closed(const brep::Mesh& solid) {
  for (const auto halfedge : solid.halfedges()) {
    if (!solid.is_boundary(halfedge)) continue;
    const OpenMesh::Vec3d& p = solid.point(solid.to_vertex_handle(halfedge));
    refuse("the mesh is open at (" + std::to_string(p[0]) + ", " + std::to_string(p[1]) + ", " +
           std::to_string(p[2]) + ") mm, so it has no inside: close its holes first");
  }
}

/// Pass 1. Faces marked as deleted become triangles without extent, which cut nothing. Throws where a point
/// is not finite.
std::vector<Corners> triangles_in_index_space(const voxel::Universe& universe, const brep::Mesh& solid) {
  const VoxelFromLps voxel_from_lps(universe);
  std::vector<glm::dvec3> points(solid.n_vertices());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t v) {
    const OpenMesh::Vec3d& p = solid.point(OpenMesh::VertexHandle(static_cast<int>(v)));
    points[v] = voxel_from_lps({p[0], p[1], p[2]});
  });
  for (std::size_t v = 0; v < points.size(); ++v)
    if (!std::isfinite(points[v].x + points[v].y + points[v].z))
      refuse("vertex " + std::to_string(v) + " is not finite");

  std::vector<Corners> triangles(solid.n_faces());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t f) {
    const OpenMesh::FaceHandle face(static_cast<int>(f));
    if (solid.status(face).deleted()) return;
    OpenMesh::HalfedgeHandle halfedge = solid.halfedge_handle(face);
    for (glm::dvec3& corner : triangles[f]) {
      corner = points[static_cast<std::size_t>(solid.to_vertex_handle(halfedge).idx())];
      halfedge = solid.next_halfedge_handle(halfedge);
    }
  });
  return triangles;
}

/// The numbers of the triangles that cut layers of each slab, slab after slab.
struct SlabLists {
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> triangles;
};

SlabLists sort_into_slabs(const std::vector<Corners>& triangles, int side, int slab_count) {
  const auto slabs_of = [&](const Corners& c) {
    const auto [low, high] = std::minmax({c[0].z, c[1].z, c[2].z});
    const int first = first_not_below(low, 0, side);
    const int end = first_not_below(high, 0, side);
    return first < end ? std::pair{first / block_side, (end - 1) / block_side + 1} : std::pair{0, 0};
  };
  SlabLists lists;
  lists.first.assign(static_cast<std::size_t>(slab_count) + 1, 0);
  for (const Corners& corners : triangles)
    for (auto [slab, end] = slabs_of(corners); slab < end; ++slab)
      ++lists.first[static_cast<std::size_t>(slab) + 1];
  for (std::size_t slab = 1; slab < lists.first.size(); ++slab) lists.first[slab] += lists.first[slab - 1];
  lists.triangles.resize(lists.first.back());
  std::vector<std::size_t> next(lists.first.begin(), lists.first.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (auto [slab, end] = slabs_of(triangles[t]); slab < end; ++slab)
      lists.triangles[next[static_cast<std::size_t>(slab)]++] = static_cast<std::uint32_t>(t);
  return lists;
}

/// Sixteen layers of voxels as rows of bits along x.
class Slab {
 public:
  Slab(int side, int first_z)
      : side_(side),
        first_z_(first_z),
        end_z_(std::min(first_z + block_side, side)),
        words_(static_cast<std::size_t>(std::max(side / 64, 1))),
        bits_(words_ * static_cast<std::size_t>(side) * block_side, 0),
        touched_(static_cast<std::size_t>(side) * block_side, 0) {}

  void flip_crossings_of(const Corners& corners) {
    const auto [low, high] = std::minmax({corners[0].z, corners[1].z, corners[2].z});
    const int end = first_not_below(high, first_z_, end_z_);
    for (int z = first_not_below(low, first_z_, end_z_); z < end; ++z) {
      std::array<glm::dvec2, 2> ends;  // x and y where the layer cuts the triangle's edges
      std::size_t count = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3& a = corners[i];
        const glm::dvec3& b = corners[(i + 1) % 3];
        if ((a.z <= z) != (b.z <= z)) ends.at(count++) = a.z < b.z ? cut(a, b, z) : cut(b, a, z);
      }
      if (ends[0].y > ends[1].y) std::swap(ends[0], ends[1]);
      flip_along(ends[0], ends[1], z);
    }
  }

  void fill_rows() {
    for (std::size_t row = 0; row < touched_.size(); ++row) {
      if (touched_[row] == 0) continue;
      std::uint64_t carry = 0;
      for (std::size_t i = row * words_; i < (row + 1) * words_; ++i) {
        std::uint64_t word = bits_[i];
        for (int shift = 1; shift < 64; shift *= 2) word ^= word << shift;
        bits_[i] = word ^ carry;
        carry = std::uint64_t{0} - (bits_[i] >> 63);
      }
    }
    // A universe of less than a word's width has no voxels further on.
    if (side_ < 64)
      for (std::uint64_t& word : bits_) word &= (std::uint64_t{1} << side_) - 1;
  }

  bool touched(int block_y) const {
    const std::uint8_t* row = &touched_[row_number(block_y * block_side, 0)];
    return std::any_of(row, row + row_count() * block_side, [](std::uint8_t t) { return t != 0; });
  }

  voxel::Block block(int block_x, int block_y) const {
    // Sixteen voxels of each row: index y + 16 z.
    std::array<std::uint16_t, 256> row{};
    std::uint16_t any = 0;
    std::uint16_t all = 0xffff;
    const int rows = row_count();
    for (int y = 0; y < rows; ++y)
      for (int z = 0; z < block_side; ++z) {
        const std::uint64_t word =
            bits_[row_number(block_y * block_side + y, z) * words_ + static_cast<std::size_t>(block_x / 4)];
        const auto sixteen = static_cast<std::uint16_t>(word >> (block_side * (block_x % 4)));
        row[voxel_row(y, z)] = sixteen;
        any |= sixteen;
        all &= sixteen;
      }
    if (any == 0) return {};
    if (all == 0xffff && rows == block_side) return voxel::make_leaf_block(voxel::all_children, 0, nullptr);
    return leaf_block(row);
  }

 private:
  /// Rows of a block that exist: universes of fewer than 16 voxels a side have fewer.
  int row_count() const { return std::min(block_side, side_); }
  /// All layers of a row stand together.
  std::size_t row_number(int y, int z_in_slab) const {
    return static_cast<std::size_t>(y) * block_side + static_cast<std::size_t>(z_in_slab);
  }

  /// The place of a row within a block's 256.
  static std::size_t voxel_row(int y, int z) {
    return static_cast<std::size_t>(y) + static_cast<std::size_t>(z) * block_side;
  }

  /// Where layer z cuts the edge from `low` to `high`, the lower end first: both triangles on the edge get
  /// the same bits.
  static glm::dvec2 cut(const glm::dvec3& low, const glm::dvec3& high, int z) {
    const double t = (z - low.z) / (high.z - low.z);
    return glm::dvec2(low) + t * (glm::dvec2(high) - glm::dvec2(low));
  }

  void flip_along(const glm::dvec2& from, const glm::dvec2& to, int z) {
    const int end = first_not_below(to.y, 0, side_);
    for (int y = first_not_below(from.y, 0, side_); y < end; ++y) {
      const double t = (y - from.y) / (to.y - from.y);
      const int x = first_not_below(from.x + t * (to.x - from.x), 0, side_);
      if (x == side_) continue;
      const std::size_t row = row_number(y, z - first_z_);
      bits_[row * words_ + static_cast<std::size_t>(x / 64)] ^= std::uint64_t{1} << (x % 64);
      touched_[row] = 1;
    }
  }

  static voxel::Block leaf_block(const std::array<std::uint16_t, 256>& row) {
    std::array<std::uint64_t, 64> words{};
    for (int z = 0; z < block_side; ++z)
      for (int y = 0; y < block_side; ++y) {
        const std::uint64_t sixteen = row[voxel_row(y, z)];
        const int shift = voxel::child_index(0, y % 4, z % 4);
        for (int x = 0; x < 4; ++x)
          words[static_cast<std::size_t>(voxel::child_index(x, y / 4, z / 4))] |= ((sixteen >> (4 * x)) & 15)
                                                                                  << shift;
      }
    return voxel::make_leaf_block(0, voxel::all_children, words.data());
  }

  int side_, first_z_, end_z_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
  std::vector<std::uint8_t> touched_;
};

}  // namespace

voxel::Octree voxelise(const voxel::Universe& universe, const brep::Mesh& solid) {
  const int side = universe.side();
  const int blocks = std::max(side / block_side, 1);
  check_closed(solid);
  const std::vector<Corners> triangles = triangles_in_index_space(universe, solid);
  const SlabLists lists = sort_into_slabs(triangles, side, blocks);

  const auto n = static_cast<std::size_t>(blocks);
  std::vector<voxel::Block> grid(n * n * n);
  tbb::parallel_for(0, blocks, [&](int z) {
    const auto slab_number = static_cast<std::size_t>(z);
    if (lists.first[slab_number] == lists.first[slab_number + 1]) return;
    Slab slab(side, z * block_side);
    for (std::size_t i = lists.first[slab_number]; i < lists.first[slab_number + 1]; ++i)
      slab.flip_crossings_of(triangles[lists.triangles[i]]);
    slab.fill_rows();
    for (int y = 0; y < blocks; ++y) {
      if (!slab.touched(y)) continue;
      for (int x = 0; x < blocks; ++x)
        grid[(slab_number * n + static_cast<std::size_t>(y)) * n + static_cast<std::size_t>(x)] =
            slab.block(x, y);
    }
  });
  return voxel::octree_of_blocks(universe, [&](const glm::ivec3& block) {
    return std::move(grid[(static_cast<std::size_t>(block.z) * n + static_cast<std::size_t>(block.y)) * n +
                          static_cast<std::size_t>(block.x)]);
  });
}

}  // namespace octotomy::convert
