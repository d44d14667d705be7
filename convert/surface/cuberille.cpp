// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/cuberille.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>
#include <map>
#include <string>
#include <tbb/parallel_for.h>

#include "convert/surface/marching_cubes.h"
#include "voxel/space/shared_progress.h"
#include "voxel/tree/corner_patterns.h"

// The surface is dual to that of marching cubes: the eight voxels around a corner are a cube of samples. The
// faces that meet at the corner are the cube's crossed edges, and the sheets are its loops. The passes:
//
// 1 Every plane of corners counts its sheets; a running sum gives every plane its first point.
// 2 Every layer of voxels, with the planes below and above it, writes the planes' points and the layer's
//   faces. The plane below a layer belongs to that layer.
// 3 Faces on an edge that two sheets share between the same points wait until all points are numbered: then
//   each such edge gets a point half way, which the later of the two sheets goes through.

namespace octotomy::convert {
namespace {

/// The sheets about a corner by the pattern of its eight voxels, bit x + 2y + 4z.
struct Sheets {
  std::uint8_t count = 0;
  std::array<std::uint8_t, 12> of_edge{};  ///< sheet of each face, by the marching cube's edge that it
                                           ///< crosses
};

std::array<Sheets, 256> sheets_of(Touching touching) {
  std::array<Sheets, 256> sheets;
  for (int inside = 0; inside < 256; ++inside) {
    // A case of marching cubes has a loop for each part of its inside corners, which are joined by edges of
    // the cube only. The case of the outside corners, if used instead, joins inside corners across a face.
    const MarchingCubesCase& mc = marching_cubes_case(touching == Touching::Apart ? inside : 255 - inside);
    Sheets& target = sheets[static_cast<std::size_t>(inside)];
    for (const std::vector<int>& loop : mc.loops) {
      for (const int edge : loop) target.of_edge[static_cast<std::size_t>(edge)] = target.count;
      ++target.count;
    }
  }
  return sheets;
}

/// The corners (x, y) of one plane that have faces, their pattern and first point.
struct CornerPlane {
  explicit CornerPlane(int side)
      : corners(static_cast<std::size_t>(side) + 1),
        pattern(corners * corners, 0),
        first(corners * corners, 0) {}
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * corners + static_cast<std::size_t>(x);
  }
  std::size_t corners;
  std::vector<std::uint8_t> pattern;
  std::vector<std::uint32_t> first;
};

/// A face with the four corners that surround it.
struct Quad {
  std::array<glm::ivec3, 4> corners;
  std::array<std::uint32_t, 4> points;
  std::uint8_t bent = 0;  ///< bit i: the side from corner i goes through a point half way
};

/// An edge of the lattice by its lower corner, and its axis.
struct EdgeKey {
  std::array<int, 4> zyx_axis;
  auto operator<=>(const EdgeKey&) const = default;
};

EdgeKey key_of(const glm::ivec3& a, const glm::ivec3& b) {
  const glm::ivec3 low = glm::min(a, b);
  const int axis = a.x != b.x ? 0 : a.y != b.y ? 1 : 2;
  return {{low.z, low.y, low.x, axis}};
}

class Cuberille {
 public:
  Cuberille(const voxel::Octree& octree, Touching touching)
      : octree_(octree), side_(octree.universe().side()), touching_(touching), sheets_(sheets_of(touching)) {
    surface_.universe = octree.universe();
  }

  LatticeSurface run(const voxel::Progress& progress) {
    count(voxel::part_of(progress, 0.0, 0.2));
    layers_.resize(static_cast<std::size_t>(side_) + 1);
    const voxel::Progress writing = voxel::part_of(progress, 0.2, 1.0);
    voxel::SharedProgress layers_done(writing, layers_.size());
    tbb::parallel_for(0, side_ + 1, [&](int z) {
      layers_done.one_more();
      write_layer(z);
    });
    gather();
    return std::move(surface_);
  }

 private:
  struct Layer {
    std::vector<std::array<std::uint32_t, 3>> faces;
    std::vector<Quad> bent;
  };

  /// Slice z, or nullptr outside the universe.
  const voxel::SliceBits* read(int z, voxel::SliceBits& slice) const {
    if (z < 0 || z >= side_) return nullptr;
    voxel::read_slice(octree_, z, slice);
    return &slice;
  }

  void count(const voxel::Progress& progress) {
    std::vector<std::uint64_t> points(static_cast<std::size_t>(side_) + 1, 0);
    voxel::SharedProgress planes_done(progress, points.size());
    tbb::parallel_for(0, side_ + 1, [&](int z) {
      planes_done.one_more();
      voxel::SliceBits low;
      voxel::SliceBits high;
      const voxel::SliceBits* below = read(z - 1, low);
      const voxel::SliceBits* above = read(z, high);
      std::uint64_t here = 0;
      voxel::for_each_corner(below, above, side_,
                             [&](int, int, std::uint8_t pattern) { here += sheets_[pattern].count; });
      points[static_cast<std::size_t>(z)] = here;
    });
    std::uint64_t total = 0;
    for (const std::uint64_t here : points) {
      first_of_plane_.push_back(static_cast<std::uint32_t>(total));
      total += here;
    }
    check_number(total, "points");
    surface_.points_half.resize(total);
  }

  static void check_number(std::uint64_t number, const std::string& what) {
    if (number > std::numeric_limits<std::uint32_t>::max())
      throw voxel::Error(voxel::ErrorCode::Resource,
                         "the cuberille would have " + std::to_string(number) + " " + what +
                             ", more than 32-bit numbers can name: crop the object or take larger voxels");
  }

  void number_plane(const voxel::SliceBits* below, const voxel::SliceBits* above, int z,
                    CornerPlane& plane) const {
    std::uint32_t next = first_of_plane_[static_cast<std::size_t>(z)];
    voxel::for_each_corner(below, above, side_, [&](int x, int y, std::uint8_t pattern) {
      plane.pattern[plane.index(x, y)] = pattern;
      plane.first[plane.index(x, y)] = next;
      next += sheets_[pattern].count;
    });
  }

  /// Writes the points of the plane of corners below layer z, the faces in that plane, and the layer's
  /// upright faces.
  void write_layer(int z) {
    voxel::SliceBits slice_below;
    voxel::SliceBits slice_here;
    voxel::SliceBits slice_above;
    const voxel::SliceBits* below = read(z - 1, slice_below);
    const voxel::SliceBits* here = read(z, slice_here);
    const voxel::SliceBits* above = read(z + 1, slice_above);
    CornerPlane low(side_);
    number_plane(below, here, z, low);
    voxel::for_each_corner(below, here, side_, [&](int x, int y, std::uint8_t pattern) {
      for (std::uint32_t i = 0; i < sheets_[pattern].count; ++i)
        surface_.points_half[low.first[low.index(x, y)] + i] = 2 * glm::ivec3(x, y, z);
    });
    CornerPlane high(z < side_ ? side_ : 0);
    if (here != nullptr) number_plane(here, above, z + 1, high);

    Layer& layer = layers_[static_cast<std::size_t>(z)];
    const auto planes = std::array{&low, &high};
    for (int y = 0; y <= side_; ++y) {
      const voxel::RowBits row = voxel::row_of(here, y);
      const voxel::RowBits before = voxel::row_of(here, y - 1);
      const voxel::RowBits under = voxel::row_of(below, y);
      for (int word = 0; word <= side_ / 64; ++word) {
        for_each_bit(row.behind(word) ^ row.ahead(word), row.ahead(word), [&](int bit, bool up) {
          add_face(planes, {64 * word + bit, y, z}, 0, up, layer);
        });
        for_each_bit(before.ahead(word) ^ row.ahead(word), row.ahead(word), [&](int bit, bool up) {
          add_face(planes, {64 * word + bit, y, z}, 1, up, layer);
        });
        for_each_bit(under.ahead(word) ^ row.ahead(word), row.ahead(word), [&](int bit, bool up) {
          add_face(planes, {64 * word + bit, y, z}, 2, up, layer);
        });
      }
    }
  }

  template <typename F>
  static void for_each_bit(std::uint64_t bits, std::uint64_t inside, const F& f) {
    for (; bits != 0; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      f(bit, ((inside >> bit) & 1) != 0);
    }
  }

  /// Adds the face between voxel `v` and the voxel before it along `axis`. `upper_inside`: `v` is the voxel
  /// inside.
  void add_face(const std::array<CornerPlane*, 2>& planes, const glm::ivec3& v, int axis, bool upper_inside,
                Layer& layer) const {
    // Orders the corners so that the normal is along -axis if the upper voxel is inside.
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    Quad quad{};
    for (int i = 0; i < 4; ++i) {
      const int turn = upper_inside ? 3 - i : i;
      glm::ivec3 corner = v;
      corner[b] += turn == 1 || turn == 2 ? 1 : 0;
      corner[c] += turn >= 2 ? 1 : 0;
      quad.corners[static_cast<std::size_t>(i)] = corner;
      quad.points[static_cast<std::size_t>(i)] = point(planes, v, corner, axis);
    }
    for (std::size_t i = 0; i < 4; ++i)
      if (is_bent(planes, v, axis, quad, i)) quad.bent = static_cast<std::uint8_t>(quad.bent | (1U << i));
    if (quad.bent != 0) {
      layer.bent.push_back(quad);
      return;
    }
    layer.faces.push_back({quad.points[0], quad.points[1], quad.points[2]});
    layer.faces.push_back({quad.points[0], quad.points[2], quad.points[3]});
  }

  /// Number (0..11) of the marching-cubes edge that passes through the face, in the cube of eight voxels
  /// around `corner`.
  static int edge_at(const glm::ivec3& v, const glm::ivec3& corner, int axis) {
    const int b = axis == 0 ? 1 : 0;
    const int c = axis == 2 ? 1 : 2;
    return 4 * axis + (v[b] - corner[b] + 1) + 2 * (v[c] - corner[c] + 1);
  }

  std::uint32_t point(const std::array<CornerPlane*, 2>& planes, const glm::ivec3& v,
                      const glm::ivec3& corner, int axis) const {
    assert(corner.z == v.z || corner.z == v.z + 1);
    const CornerPlane& plane = *planes[static_cast<std::size_t>(corner.z - v.z)];
    const std::size_t at = plane.index(corner.x, corner.y);
    return plane.first[at] +
           sheets_[plane.pattern[at]].of_edge[static_cast<std::size_t>(edge_at(v, corner, axis))];
  }

  /// Whether the face's side from corner i runs between the same two points as another sheet and must bend.
  /// Of the two sheets about the lattice edge, the one with the lowest-numbered cube edge stays straight.
  bool is_bent(const std::array<CornerPlane*, 2>& planes, const glm::ivec3& v, int axis, const Quad& quad,
               std::size_t i) const {
    const glm::ivec3& from = quad.corners[i];
    const glm::ivec3& to = quad.corners[(i + 1) % 4];
    const int along = from.x != to.x ? 0 : from.y != to.y ? 1 : 2;
    const CornerPlane& plane = *planes[static_cast<std::size_t>(from.z - v.z)];
    const CornerPlane& far = *planes[static_cast<std::size_t>(to.z - v.z)];
    const int pattern = plane.pattern[plane.index(from.x, from.y)];
    const Sheets& here = sheets_[static_cast<std::size_t>(pattern)];
    const Sheets& there = sheets_[far.pattern[far.index(to.x, to.y)]];
    const int side = to[along] > from[along] ? 1 : 0;
    const std::array<int, 4> around = edges_of_face(2 * along + side);
    const std::uint16_t crossed = marching_cubes_case(pattern).crossed;
    for (const int edge : around)
      if (((crossed >> edge) & 1) == 0) return false;
    // The edge is doubled only if all four faces about it share one point at each end.
    const int flip = 1 << along;
    const auto across = [&](int edge) {
      // The cube edge that the same face crosses in the cube about the other end.
      const std::array<int, 2> ends = corners_of_edge(edge);
      const int a = std::min(ends[0] ^ flip, ends[1] ^ flip);
      for (int e = 0; e < 12; ++e)
        if (corners_of_edge(e)[0] == a && corners_of_edge(e)[1] == (a ^ (ends[0] ^ ends[1]))) return e;
      return -1;
    };
    for (const int edge : around)
      if (here.of_edge[static_cast<std::size_t>(edge)] != here.of_edge[static_cast<std::size_t>(around[0])] ||
          there.of_edge[static_cast<std::size_t>(across(edge))] !=
              there.of_edge[static_cast<std::size_t>(across(around[0]))])
        return false;
    return shared_voxel(pattern, edge_at(v, from, axis)) !=
           shared_voxel(pattern, *std::min_element(around.begin(), around.end()));
  }

  /// The voxel that a face about a doubled edge shares with the other face of its sheet: the inside one if
  /// touching voxels are kept apart, else the outside one.
  int shared_voxel(int pattern, int edge) const {
    const std::array<int, 2> ends = corners_of_edge(edge);
    const bool first_inside = ((pattern >> ends[0]) & 1) != 0;
    return first_inside == (touching_ == Touching::Apart) ? ends[0] : ends[1];
  }

  void gather() {
    std::map<EdgeKey, std::uint32_t> middles;
    std::uint64_t faces = 0;
    for (const Layer& layer : layers_) {
      faces += layer.faces.size();
      for (const Quad& quad : layer.bent)
        for (std::size_t i = 0; i < 4; ++i)
          if (((quad.bent >> i) & 1) != 0)
            middles.try_emplace(key_of(quad.corners[i], quad.corners[(i + 1) % 4]), 0);
    }
    check_number(faces, "triangles");
    for (auto& [key, number] : middles) {
      number = static_cast<std::uint32_t>(surface_.points_half.size());
      const auto& [z, y, x, axis] = key.zyx_axis;
      glm::ivec3 p(2 * x, 2 * y, 2 * z);
      p[axis] += 1;
      surface_.points_half.push_back(p);
    }
    surface_.faces.reserve(faces);
    for (const Layer& layer : layers_)
      surface_.faces.insert(surface_.faces.end(), layer.faces.begin(), layer.faces.end());
    for (const Layer& layer : layers_)
      for (const Quad& quad : layer.bent) add_bent(quad, middles);
    check_number(std::max(surface_.points_half.size(), surface_.faces.size()), "points or triangles");
  }

  /// Adds triangles from the face's middle to its sides. None is degenerate, whichever sides are bent.
  void add_bent(const Quad& quad, const std::map<EdgeKey, std::uint32_t>& middles) {
    const auto centre = static_cast<std::uint32_t>(surface_.points_half.size());
    surface_.points_half.push_back(quad.corners[0] + quad.corners[2]);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t from = quad.points[i];
      const std::uint32_t to = quad.points[(i + 1) % 4];
      if (((quad.bent >> i) & 1) == 0) {
        surface_.faces.push_back({centre, from, to});
        continue;
      }
      const std::uint32_t middle = middles.at(key_of(quad.corners[i], quad.corners[(i + 1) % 4]));
      surface_.faces.push_back({centre, from, middle});
      surface_.faces.push_back({centre, middle, to});
    }
  }

  const voxel::Octree& octree_;
  int side_;
  Touching touching_;
  std::array<Sheets, 256> sheets_;
  std::vector<std::uint32_t> first_of_plane_;
  std::vector<Layer> layers_;
  LatticeSurface surface_;
};

}  // namespace

LatticeSurface cuberille(const voxel::Octree& octree, Touching touching, const voxel::Progress& progress) {
  return Cuberille(octree, touching).run(progress);
}

brep::Triangles triangles_of(const LatticeSurface& surface) {
  const voxel::Lattice lattice = surface.universe.lattice();
  brep::Triangles triangles;
  triangles.points_mm.resize(surface.points_half.size());
  tbb::parallel_for(std::size_t{0}, surface.points_half.size(), [&](std::size_t i) {
    triangles.points_mm[i] = lattice.lps_mm(0.5 * glm::dvec3(surface.points_half[i]) - 0.5);
  });
  triangles.faces = surface.faces;
  if (!lattice.right_handed())
    for (std::array<std::uint32_t, 3>& face : triangles.faces) std::swap(face[1], face[2]);
  return triangles;
}

}  // namespace octotomy::convert
