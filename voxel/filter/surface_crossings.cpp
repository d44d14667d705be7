// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/surface_crossings.h"

#include <algorithm>
#include <limits>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "voxel/tree/voxel_boundary.h"

namespace octotomy::voxel {
namespace {

constexpr std::size_t no_crossing_there = std::numeric_limits<std::size_t>::max();

glm::ivec3 axis_step(int axis) {
  glm::ivec3 step(0);
  step[axis] = 1;
  return step;
}

/// A number that identifies a voxel, in the universe or beside it, together with an axis; 3 means no axis.
std::uint64_t key_of(const glm::ivec3& voxel, int axis) {
  constexpr int bits = 20;
  const glm::u64vec3 from(voxel + 2);
  return (((from.z << bits | from.y) << bits | from.x) << 2) | static_cast<std::uint64_t>(axis);
}
glm::ivec3 voxel_of(std::uint64_t key) {
  constexpr int bits = 20;
  constexpr std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  const std::uint64_t at = key >> 2;
  return glm::ivec3(static_cast<int>(at & mask), static_cast<int>((at >> bits) & mask),
                    static_cast<int>(at >> (2 * bits))) -
         2;
}

template <typename Value>
void sort_and_unify(std::vector<Value>& values) {
  tbb::parallel_sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Whether a voxel's face lies on the universe's border and the solid continues beyond the border, so that it
/// has no surface there.
bool goes_on_beyond(const VoxelFace& face, const Universe& universe, const Membership& contains) {
  glm::ivec3 beyond = face.voxel;
  beyond[face.axis] += face.side;
  return (beyond[face.axis] < 0 || beyond[face.axis] >= universe.side()) &&
         contains(universe.lattice().lps_mm(glm::dvec3(beyond)));
}

template <typename Find>
void append(const std::vector<std::uint64_t>& keys, std::vector<glm::dvec3>& to, const Find& find) {
  std::vector<std::pair<bool, glm::dvec3>> found(keys.size());
  tbb::parallel_for(std::size_t{0}, keys.size(), [&](std::size_t i) { found[i] = find(keys[i]); });
  for (const auto& [is_there, at] : found)
    if (is_there) to.push_back(at);
}

}  // namespace

SurfaceCrossings::SurfaceCrossings(const Octree& octree, const Expression& solid)
    : octree_(octree), solid_(solid) {
  const std::vector<VoxelFace> faces = voxel_boundary(octree);
  const Lattice lattice = octree.universe().lattice();
  const Membership contains(octree.universe(), solid);
  constexpr std::uint64_t no_key = std::numeric_limits<std::uint64_t>::max();
  std::vector<std::pair<std::uint64_t, double>> found(faces.size());
  tbb::parallel_for(std::size_t{0}, faces.size(), [&](std::size_t i) {
    const VoxelFace& face = faces[i];
    const glm::ivec3 step = face.side * axis_step(face.axis);
    if (goes_on_beyond(face, octree.universe(), contains)) {
      found[i].first = no_key;
      return;
    }
    // The crossing's position on the edge, 0 at the inner end and 1 at the outer end, by eight halvings: the
    // error is below a hundredth of the edge.
    double in = 0.0, out = 1.0;
    for (int halving = 0; halving < 8; ++halving) {
      const double middle = 0.5 * (in + out);
      (contains(lattice.lps_mm(glm::dvec3(face.voxel) + middle * glm::dvec3(step))) ? in : out) = middle;
    }
    const double share = 0.5 * (in + out);
    found[i] = face.side > 0 ? std::pair{key_of(face.voxel, face.axis), share}
                             : std::pair{key_of(face.voxel - axis_step(face.axis), face.axis), 1.0 - share};
  });
  tbb::parallel_sort(found.begin(), found.end());
  for (const auto& [key, share] : found) {
    if (key == no_key) break;
    keys_.push_back(key);
    glm::dvec3 at(voxel_of(key));
    at[static_cast<int>(key & 3)] += share;
    points_.push_back(at);
  }
}

/// The cells that contain a crossing. A cell is identified by its lowest voxel.
std::vector<std::uint64_t> SurfaceCrossings::cells() const {
  std::vector<std::uint64_t> found;
  found.reserve(4 * keys_.size());
  for (const std::uint64_t key : keys_) {
    const int axis = static_cast<int>(key & 3);
    const glm::ivec3 at = voxel_of(key), b = axis_step((axis + 1) % 3), c = axis_step((axis + 2) % 3);
    for (const int back : {0, 1})
      for (const int also : {0, 1}) found.push_back(key_of(at - back * b - also * c, 3));
  }
  sort_and_unify(found);
  return found;
}

std::vector<glm::dvec3> SurfaceCrossings::with_middles() const {
  std::vector<std::uint64_t> squares;
  for (const std::uint64_t key : keys_) {
    const int axis = static_cast<int>(key & 3);
    const glm::ivec3 at = voxel_of(key), b = axis_step((axis + 1) % 3), c = axis_step((axis + 2) % 3);
    // A square is identified by its lowest voxel and its normal.
    for (const int back : {0, 1}) {
      squares.push_back(key_of(at - back * b, (axis + 2) % 3));
      squares.push_back(key_of(at - back * c, (axis + 1) % 3));
    }
  }
  sort_and_unify(squares);
  std::vector<glm::dvec3> all = points_;
  append(squares, all, [this](std::uint64_t key) { return middle_of_chord(key); });
  append(cells(), all, [this](std::uint64_t key) { return middle_of_ring(voxel_of(key)); });
  return all;
}

std::size_t SurfaceCrossings::crossing(const glm::ivec3& from, int axis) const {
  const std::uint64_t key = key_of(from, axis);
  const auto found = std::lower_bound(keys_.begin(), keys_.end(), key);
  return found != keys_.end() && *found == key ? static_cast<std::size_t>(found - keys_.begin())
                                               : no_crossing_there;
}

/// The crossings on a square's four edges: none or two, or four if diagonally opposite corners are on the
/// same side and neighbouring ones are not.
std::vector<std::size_t> SurfaceCrossings::of_square(const glm::ivec3& low, int normal) const {
  std::vector<std::size_t> found;
  const int b = (normal + 1) % 3, c = (normal + 2) % 3;
  for (const int far : {0, 1})
    for (const auto& [along, across] : {std::pair{b, c}, std::pair{c, b}})
      if (const std::size_t at = crossing(low + far * axis_step(across), along); at != no_crossing_there)
        found.push_back(at);
  return found;
}

/// In a square with four crossings, the chords separate the two corners inside the solid.
void SurfaceCrossings::add_chords(const glm::ivec3& low, int normal, std::vector<Chord>& chords) const {
  const std::vector<std::size_t> ends = of_square(low, normal);
  if (ends.size() == 2) chords.emplace_back(ends[0], ends[1]);
  if (ends.size() != 4) return;
  // The first two crossings lie on edges that meet at the lowest corner, the last two on edges that meet at
  // the highest.
  const bool is_low_inside = octree_.contains(low);
  chords.emplace_back(ends[0], ends[is_low_inside ? 1 : 3]);
  chords.emplace_back(ends[2], ends[is_low_inside ? 3 : 1]);
}

SurfaceCrossings::Middle SurfaceCrossings::middle_of_chord(std::uint64_t square) const {
  const std::vector<std::size_t> ends = of_square(voxel_of(square), static_cast<int>(square & 3));
  if (ends.size() != 2) return {};
  return {true, 0.5 * (points_[ends[0]] + points_[ends[1]])};
}

/// The mean of a cell's crossings, if chords join all of them to one ring; a single sheet of the surface then
/// passes through the cell.
SurfaceCrossings::Middle SurfaceCrossings::middle_of_ring(const glm::ivec3& low) const {
  std::vector<Chord> chords;
  for (int normal = 0; normal < 3; ++normal)
    for (const int far : {0, 1}) {
      const std::vector<std::size_t> ends = of_square(low + far * axis_step(normal), normal);
      if (ends.size() > 2) return {};
      if (ends.size() == 2) chords.emplace_back(ends[0], ends[1]);
    }
  if (chords.size() < 3) return {};
  // Follows the chords around the ring. Each crossing belongs to two chords, because its edge lies in two
  // of the cell's squares.
  glm::dvec3 sum = points_[chords[0].first];
  std::size_t at = chords[0].second, used = 0, count = 1;
  for (; at != chords[0].first; ++count) {
    sum += points_[at];
    for (std::size_t i = 1; i < chords.size(); ++i) {
      if (i == used || (chords[i].first != at && chords[i].second != at)) continue;
      at = chords[i].first == at ? chords[i].second : chords[i].first;
      used = i;
      break;
    }
  }
  if (count != chords.size()) return {};
  return {true, sum / static_cast<double>(count)};
}

/// The middle of a ring, moved out of the solid to its surface: at an edge of the solid, onto that edge or near
/// it. Positions are in voxels.
glm::dvec3 SurfaceCrossings::outer_middle(const std::vector<std::size_t>& ring, const glm::ivec3& low,
                                          const Membership& contains) const {
  const std::size_t count = ring.size() - 1;
  glm::dvec3 middle(0.0), normal(0.0);
  for (std::size_t i = 0; i < count; ++i) middle += points_[ring[i]] / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i)
    normal += glm::cross(points_[ring[i]] - middle, points_[ring[i + 1]] - middle);
  const double area = glm::length(normal);
  if (area == 0.0) return middle;
  // The outward direction points away from the inner end of an edge that the ring crosses.
  const std::uint64_t key = keys_[ring.front()];
  const glm::ivec3 from = voxel_of(key);
  const double side = octree_.contains(from) ? 1.0 : -1.0;
  normal *= (normal[static_cast<int>(key & 3)] * side < 0.0 ? -1.0 : 1.0) / area;
  const Lattice lattice = octree_.universe().lattice();
  const auto is_inside = [&](double out) { return contains(lattice.lps_mm(middle + out * normal)); };
  // The middle is moved only within the cell, because a cut-off edge or corner lies in the cell's middle
  // part.
  constexpr double most = 0.75;
  double in = 0.0, out = most;
  if (!is_inside(in) || is_inside(out)) return middle;
  for (int halving = 0; halving < 6; ++halving) {
    const double half = 0.5 * (in + out);
    (is_inside(half) ? in : out) = half;
  }
  const glm::dvec3 moved = middle + in * normal;
  const glm::dvec3 in_cell = moved - glm::dvec3(low);
  const bool is_in_cell = glm::all(glm::greaterThanEqual(in_cell, glm::dvec3(0.0))) &&
                          glm::all(glm::lessThanEqual(in_cell, glm::dvec3(1.0)));
  return is_in_cell ? moved : middle;
}

void SurfaceCrossings::for_triangles(
    const std::function<void(const std::array<glm::dvec3, 3>& corners)>& visit) const {
  const std::vector<std::uint64_t> all = cells();
  const Membership contains(octree_.universe(), solid_);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t cell) {
    const glm::ivec3 low = voxel_of(all[cell]);
    std::vector<Chord> chords;
    for (int normal = 0; normal < 3; ++normal)
      for (const int far : {0, 1}) add_chords(low + far * axis_step(normal), normal, chords);
    while (!chords.empty()) {
      std::vector<std::size_t> ring{chords.back().first, chords.back().second};
      chords.pop_back();
      while (ring.back() != ring.front()) {
        const auto next = std::find_if(chords.begin(), chords.end(), [&](const Chord& chord) {
          return chord.first == ring.back() || chord.second == ring.back();
        });
        if (next == chords.end()) break;
        ring.push_back(next->first == ring.back() ? next->second : next->first);
        chords.erase(next);
      }
      const glm::dvec3 middle = outer_middle(ring, low, contains);
      for (std::size_t i = 0; i + 1 < ring.size(); ++i)
        visit({middle, points_[ring[i]], points_[ring[i + 1]]});
    }
  });
}

}  // namespace octotomy::voxel
