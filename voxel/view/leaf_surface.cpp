// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/leaf_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "voxel/space/vector_clones.h"

// The search of ray_surface.cpp, for several rays at once in vectors: 1 copy the samples about the leaf in
// fours (LeafSurface::fours_); 2 interpolate them at the entries; 3 choose the voxel's face where the object
// was cut; 4 probe along the other rays until their sample crosses the threshold; 5 interpolate the crossing.
// All rays execute the same steps; a step that a ray does not need has no effect on it.

// Vectors are passed only between functions of this file, which are all inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace octotomy::voxel {
namespace {

constexpr int lanes = 8;
constexpr int row = LeafSurface::side;
constexpr int layer = row * row;

/// The sample that is used for voxels beyond the universe, so that these count as cut away.
constexpr std::int16_t beyond = std::numeric_limits<std::int16_t>::max();

// Vectors with one number for each ray. A comparison yields -1 for rays for which it is true.
using Float = float __attribute__((vector_size(4 * lanes)));
using Int = std::int32_t __attribute__((vector_size(4 * lanes)));
using Double4 = double __attribute__((vector_size(32)));
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

template <typename Vector, typename Value>
[[gnu::always_inline]] inline Vector load(const Value* from) {
  Vector vector;
  std::memcpy(&vector, from, sizeof vector);
  return vector;
}
template <typename Vector, typename Value>
[[gnu::always_inline]] inline void store(const Vector& vector, Value* to) {
  std::memcpy(to, &vector, sizeof vector);
}
template <typename Vector>
[[gnu::always_inline]] inline Vector clamped(const Vector& v, const Vector& low, const Vector& high) {
  const Vector least = v < low ? low : v;
  return least > high ? high : least;
}
template <typename Whole, typename Half>
[[gnu::always_inline]] inline Whole joined(const Half& low, const Half& high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
[[gnu::always_inline]] inline Float floats(const Double4& low, const Double4& high) {
  return joined<Float>(__builtin_convertvector(low, Float4), __builtin_convertvector(high, Float4));
}
[[gnu::always_inline]] inline bool any(const Int& mask) {
  using Longs = std::int64_t __attribute__((vector_size(4 * lanes)));
  const auto longs = reinterpret_cast<Longs>(mask);
  return ((longs[0] | longs[1]) | (longs[2] | longs[3])) != 0;
}

/// The values that all rays share.
struct Way {
  double per_mm[3];
  float half_voxel_mm = 0.0f;
  float threshold = 0.0f;
};

/// The samples around a leaf.
struct Leaf {
  const std::uint64_t* fours = nullptr;
  Int first[3];                   ///< voxel to which the first entry of `fours` belongs
  Int low_cell[3], high_cell[3];  ///< range of cells whose fours are in memory
  std::int32_t corner = 0;        ///< number of the leaf's first voxel in the mirrored frame
  std::int32_t stride[3];         ///< distance in `fours` from a voxel to the next one along an axis
};

/// The samples of a moved object, and the map from its voxels to these samples.
struct StillSamples {
  const GreyOctree* grey = nullptr;
  glm::dmat4 still_from_voxel{1.0};
};

/// Positions of rays, counted from a voxel near their entry as in RaySamples.
struct Origins {
  Float p[3];
  Int first[3];
};

/// For each ray, two samples that are neighbours along x.
struct Pairs {
  Int pairs;
  [[gnu::always_inline]] Float left() const { return __builtin_convertvector((pairs << 16) >> 16, Float); }
  [[gnu::always_inline]] Float right() const { return __builtin_convertvector(pairs >> 16, Float); }
};
/// For each ray, two pairs that are neighbours along y.
struct Fours {
  Pairs near, far;
};
/// Fours by their numbers.
[[gnu::always_inline]] inline Fours fours_at(const std::uint64_t* __restrict fours, const Int& numbers) {
  using Long4 = std::uint64_t __attribute__((vector_size(4 * lanes)));
  alignas(64) std::uint32_t at[lanes];
  store(numbers, at);
  // In this order both shuffles exchange only numbers within the same half of a vector.
  const auto low = reinterpret_cast<Int>(Long4{fours[at[0]], fours[at[1]], fours[at[4]], fours[at[5]]});
  const auto high = reinterpret_cast<Int>(Long4{fours[at[2]], fours[at[3]], fours[at[6]], fours[at[7]]});
  return {{__builtin_shufflevector(low, high, 0, 2, 8, 10, 4, 6, 12, 14)},
          {__builtin_shufflevector(low, high, 1, 3, 9, 11, 5, 7, 13, 15)}};
}

/// Interpolates, as RaySamples does, from the eight samples around each position, numbered x + 2y + 4z.
[[gnu::always_inline]] inline Float mixed(const Float corners[8], const Float t[3]) {
  const auto mix = [](const Float& from, const Float& to, const Float& share) __attribute__((always_inline)) {
    return from + (to - from) * share;
  };
  const Float left = mix(mix(corners[0], corners[4], t[2]), mix(corners[2], corners[6], t[2]), t[1]);
  const Float right = mix(mix(corners[1], corners[5], t[2]), mix(corners[3], corners[7], t[2]), t[1]);
  return mix(left, right, t[0]);
}

/// For positions at a distance from the rays' entries, along one axis: the cells that contain them, and their
/// places within the cells.
[[gnu::always_inline]] inline Int cell_of(const Way& way, const Origins& origins, int axis,
                                          const Float& distance_mm, const Int& low, const Int& high,
                                          Float& t) {
  const Float p = origins.p[axis] + distance_mm * static_cast<float>(way.per_mm[axis]);
  const Int cell = clamped(origins.first[axis] + __builtin_convertvector(p, Int), low, high);
  t = clamped(p - __builtin_convertvector(cell - origins.first[axis], Float), Float{}, Float{} + 1.0f);
  return cell;
}

/// Interpolates at the positions at a distance from the rays' entries.
[[gnu::always_inline]] inline Float interpolate(const Way& way, const Leaf& leaf, const Origins& origins,
                                                const Float& distance_mm) {
  Float t[3];
  Int at{};
  for (int axis = 2; axis >= 0; --axis) {
    const Int cell =
        cell_of(way, origins, axis, distance_mm, leaf.low_cell[axis], leaf.high_cell[axis], t[axis]);
    at = (at << 3) + (cell - leaf.first[axis]);
  }
  static_assert(row == 1 << 3);
  Float corners[8];
  for (int z = 0; z < 2; ++z) {
    const Fours four = fours_at(leaf.fours + layer * z, at);
    corners[4 * z] = four.near.left();
    corners[4 * z + 1] = four.near.right();
    corners[4 * z + 2] = four.far.left();
    corners[4 * z + 3] = four.far.right();
  }
  return mixed(corners, t);
}
[[gnu::always_inline]] inline Float interpolate(const Way& way, const StillSamples& samples,
                                                const Origins& origins, const Float& distance_mm) {
  const Int low{}, high = low + (samples.grey->universe().side() - 2);
  Float t[3];
  alignas(64) std::int32_t cells[3][lanes], values[8][lanes];
  for (int axis = 0; axis < 3; ++axis)
    store(cell_of(way, origins, axis, distance_mm, low, high, t[axis]), cells[axis]);
  for (int i = 0; i < lanes; ++i) {
    const glm::ivec3 cell(cells[0][i], cells[1][i], cells[2][i]);
    // The summand of a coordinate in the number of a brick's sample. Samples are numbered by leaves, then by
    // voxels of a leaf, each in the order x + 4y + 16z.
    const auto along = [](int at) { return ((at >> 2) & 3) * 64 + (at & 3); };
    const int number[3][2] = {{along(cell.x), along(cell.x + 1)},
                              {along(cell.y) << 2, along(cell.y + 1) << 2},
                              {along(cell.z) << 4, along(cell.z + 1) << 4}};
    const std::int16_t* const near = samples.grey->brick(cell >> 4).samples.front().data();
    // The common case: five cells in six lie within one brick.
    const bool within = ((cell ^ (cell + 1)) & ~15) == glm::ivec3(0);
    for (int corner = 0; corner < 8; ++corner) {
      const int x = corner & 1, y = (corner >> 1) & 1, z = corner >> 2;
      const std::int16_t* const from =
          within ? near : samples.grey->brick((cell + glm::ivec3(x, y, z)) >> 4).samples.front().data();
      values[corner][i] = from[number[0][x] + number[1][y] + number[2][z]];
    }
  }
  Float corners[8];
  for (int corner = 0; corner < 8; ++corner)
    corners[corner] = __builtin_convertvector(load<Int>(values[corner]), Float);
  return mixed(corners, t);
}

/// The positions near the entries of a vector's rays, from ray number `from` on.
[[gnu::always_inline]] inline Origins origins_of(const Way& way, const RayBatch& batch, int from,
                                                 const Double4 start[3][2]) {
  Origins origins;
  for (int axis = 0; axis < 3; ++axis) {
    Double4 first[2], p[2];
    for (int half = 0; half < 2; ++half) {
      p[half] = start[axis][half] + load<Double4>(batch.enter_mm.data() + from + 4 * half) * way.per_mm[axis];
      // Computes the floor: one is subtracted if the conversion rounded up.
      const Double4 whole = __builtin_convertvector(__builtin_convertvector(p[half], Int4), Double4);
      constexpr double reach = 8.0;
      first[half] = (whole > p[half] ? whole - 1.0 : whole) - reach;
    }
    origins.first[axis] =
        joined<Int>(__builtin_convertvector(first[0], Int4), __builtin_convertvector(first[1], Int4));
    origins.p[axis] = floats(p[0] - first[0], p[1] - first[1]);
  }
  return origins;
}

/// The state of the search along the rays of one vector.
struct Search {
  Origins origins;
  Int outside;  ///< rays that are outside the surface at their entry
  Int faces;    ///< rays whose surface is their voxel's face
  /// Rays whose surface lies between their last two probes; the entry counts as a probe.
  Int crossed;
  Float near_mm, far_mm;        ///< distances from the entry to these two probes
  Float near_value, far_value;  ///< samples at these two probes
};

/// Steps 2 and 3 for the rays of a leaf from number `from` on.
[[gnu::always_inline]] inline void enter(const Way& way, const Leaf& leaf, const RayBatch& batch, int from,
                                         Search& search) {
  Double4 start[3][2];
  for (int axis = 0; axis < 3; ++axis)
    for (int half = 0; half < 2; ++half)
      start[axis][half] = load<Double4>(batch.start[static_cast<std::size_t>(axis)].data() + from + 4 * half);
  search.origins = origins_of(way, batch, from, start);
  const Float entry = interpolate(way, leaf, search.origins, Float{});
  const auto through = load<Int>(batch.entered_through.data() + from);
  Int number = Int{} + leaf.corner, step_back{};
  for (int axis = 0; axis < 3; ++axis) {
    number += load<Int>(batch.at[static_cast<std::size_t>(axis)].data() + from) * leaf.stride[axis];
    step_back |= (through == axis) & leaf.stride[axis];
  }
  const Float voxel = fours_at(leaf.fours, number).near.left();
  const Float before = fours_at(leaf.fours, number - step_back).near.left();
  search.outside = entry < way.threshold;
  search.faces = (voxel < way.threshold) | ((before >= way.threshold) & ~search.outside);
  search.near_value = entry;
}

/// Step 2 for the rays of a moved object.
[[gnu::always_inline]] inline void enter(const Way& way, const StillSamples& samples, const RayBatch& batch,
                                         int from, Search& search) {
  const glm::dmat4& still = samples.still_from_voxel;
  Double4 start[3][2];
  for (int axis = 0; axis < 3; ++axis)
    for (int half = 0; half < 2; ++half) {
      Double4 p[3];
      for (int of = 0; of < 3; ++of)
        p[of] = load<Double4>(batch.start[static_cast<std::size_t>(of)].data() + from + 4 * half);
      // Adds in the order of GLM's product, for the same rounding.
      start[axis][half] =
          (still[0][axis] * p[0] + still[1][axis] * p[1]) + (still[2][axis] * p[2] + still[3][axis]);
    }
  search.origins = origins_of(way, batch, from, start);
  search.near_value = interpolate(way, samples, search.origins, Float{});
  search.outside = search.near_value < way.threshold;
  search.faces = Int{};
}

/// Step 4: a ray that enters outside the surface is probed forward through the voxel in two steps; a ray that
/// enters inside is probed back over two voxels in four steps.
template <typename Samples>
[[gnu::always_inline]] inline void probe(const Way& way, const Samples& samples, const RayBatch& batch,
                                         int from, Search& search) {
  const auto along = [&](int half) __attribute__((always_inline)) {
    const int at = from + 4 * half;
    return load<Double4>(batch.leave_mm.data() + at) - load<Double4>(batch.enter_mm.data() + at);
  };
  const Float way_mm = floats(along(0), along(1));
  const Int outside = search.outside;
  Int open = ~search.faces, crossed{};
  Float near_mm{}, far_mm{}, near_value = search.near_value, far_value = near_value;
  for (int step = 1; any(open) && step <= 4; ++step) {
    const Float probe_mm =
        outside ? way_mm * (step == 1 ? 0.5f : 1.0f) : Float{} - static_cast<float>(step) * way.half_voxel_mm;
    const Float value = interpolate(way, samples, search.origins, probe_mm);
    near_mm = open ? far_mm : near_mm;
    near_value = open ? far_value : near_value;
    far_mm = open ? probe_mm : far_mm;
    far_value = open ? value : far_value;
    const Int crosses = open & ((value < way.threshold) ^ outside);
    crossed |= crosses;
    open &= ~crosses;
    if (step >= 2) open &= ~outside;
  }
  search.crossed = crossed;
  search.faces |= open;
  search.near_mm = near_mm;
  search.far_mm = far_mm;
  search.near_value = near_value;
  search.far_value = far_value;
}

/// Step 5. Returns the distance from each ray's entry to the surface.
template <typename Samples>
[[gnu::always_inline]] inline Float crossing_mm(const Way& way, const Samples& samples,
                                                const Search& search) {
  const float threshold = way.threshold;
  const Int& outside = search.outside;
  Float below_mm = outside ? search.near_mm : search.far_mm;
  Float below_value = outside ? search.near_value : search.far_value;
  Float above_mm = outside ? search.far_mm : search.near_mm;
  Float above_value = outside ? search.far_value : search.near_value;
  // The distance of a ray without a crossing is 0.
  const Float middle_mm = search.crossed ? below_mm + (above_mm - below_mm) * (threshold - below_value) /
                                                          (above_value - below_value)
                                         : Float{};
  const Float middle = interpolate(way, samples, search.origins, middle_mm);
  const Int under = middle < threshold;
  below_mm = under ? middle_mm : below_mm;
  below_value = under ? middle : below_value;
  above_mm = under ? above_mm : middle_mm;
  above_value = under ? above_value : middle;
  const Float again_mm =
      below_mm + (above_mm - below_mm) * (threshold - below_value) / (above_value - below_value);
  const Float crossing_mm = above_value > below_value ? again_mm : middle_mm;
  return search.crossed ? crossing_mm : Float{};
}

constexpr std::int32_t nothing = 0, smooth = 1, face = 2;  // kind of surface that a ray meets

/// Executes each of steps 2 to 5 for all vectors of a batch before the next step, so that the processor can
/// overlap the work on several vectors.
template <typename Samples>
[[gnu::always_inline]] inline void find_surface(const Way& way, const Samples& samples, const RayBatch& batch,
                                                float* depth_mm, std::int32_t* kind) {
  Search searches[RayBatch::most / lanes];
  for (int i = 0; i * lanes < batch.count; ++i) enter(way, samples, batch, i * lanes, searches[i]);
  for (int i = 0; i * lanes < batch.count; ++i) probe(way, samples, batch, i * lanes, searches[i]);
  for (int i = 0; i * lanes < batch.count; ++i) {
    const int from = i * lanes;
    const Float shift = crossing_mm(way, samples, searches[i]);
    const auto depth = [&](const Float4& half_of_shift, int half) __attribute__((always_inline)) {
      return load<Double4>(batch.enter_mm.data() + from + 4 * half) +
             __builtin_convertvector(half_of_shift, Double4);
    };
    store(floats(depth(__builtin_shufflevector(shift, shift, 0, 1, 2, 3), 0),
                 depth(__builtin_shufflevector(shift, shift, 4, 5, 6, 7), 1)),
          depth_mm + from);
    store((searches[i].crossed & (Int{} + smooth)) | (searches[i].faces & (Int{} + face)), kind + from);
  }
}
OCTOTOMY_VECTOR_CLONES void find_in_leaf(const Way& way, const Leaf& leaf, const RayBatch& batch,
                                         float* depth_mm, std::int32_t* kind) {
  find_surface(way, leaf, batch, depth_mm, kind);
}
OCTOTOMY_VECTOR_CLONES void find_moved(const Way& way, const StillSamples& samples, const RayBatch& batch,
                                       float* depth_mm, std::int32_t* kind) {
  find_surface(way, samples, batch, depth_mm, kind);
}

/// Four samples of a leaf's row.
std::uint64_t row_of(const std::int16_t* leaf, int y, int z) {
  std::uint64_t four;
  std::memcpy(&four, leaf + child_index(0, y & 3, z & 3), sizeof four);
  return four;
}

/// The number of voxels in front of a leaf, along one axis, on which a surface in the leaf may depend. The
/// ray enters a voxel at most half a voxel in front of its centre. From there the search goes back by two
/// voxels along the ray, which are 2 * `share` voxels along the axis. The margin is much larger than the
/// rounding of positions.
int in_front(double share) {
  constexpr double margin = 1.0 / 64.0;
  return std::min(row - 5, static_cast<int>(std::ceil(0.5 + 2.0 * std::abs(share) + margin)));
}

/// For each voxel of a row of `row` voxels, its sample and the next one along x. The last voxel has no next
/// one and is paired with itself.
struct RowOfPairs {
  using Short8 = std::int16_t __attribute__((vector_size(16)));
  Short8 low, high;  ///< four pairs each

  RowOfPairs(std::uint64_t first, std::uint64_t last) {
    using Long2 = std::uint64_t __attribute__((vector_size(16)));
    // Pairs are combined in registers, because a read of sixteen bytes is delayed after two writes of eight.
    const auto left = reinterpret_cast<Short8>(Long2{first, last});
    const Short8 right = __builtin_shufflevector(left, left, 1, 2, 3, 4, 5, 6, 7, 7);
    low = __builtin_shufflevector(left, right, 0, 8, 1, 9, 2, 10, 3, 11);
    high = __builtin_shufflevector(left, right, 4, 12, 5, 13, 6, 14, 7, 15);
  }
};

/// Writes the fours of two rows that are neighbours along y.
void write_fours(const RowOfPairs& near, const RowOfPairs& far, std::uint64_t* fours) {
  for (const auto& [of_near, of_far] : {std::pair(near.low, far.low), std::pair(near.high, far.high)}) {
    store(__builtin_shufflevector(of_near, of_far, 0, 1, 8, 9, 2, 3, 10, 11), fours);
    store(__builtin_shufflevector(of_near, of_far, 4, 5, 12, 13, 6, 7, 14, 15), fours + 2);
    fours += 4;
  }
}

/// Writes the fours of a cube of `row` voxels a side whose y and z are from `from` up to, not including,
/// `until`. `row_at` returns the row of samples for y and z. The last row along y has no next one and is
/// paired with itself.
template <typename RowAt>
void write_cube(const glm::ivec3& from, const glm::ivec3& until, const RowAt& row_at, std::uint64_t* fours) {
  for (int z = from.z; z < until.z; ++z) {
    std::uint64_t* const to = fours + layer * z;
    RowOfPairs near = row_at(from.y, z);
    for (int y = from.y + 1; y < until.y; ++y) {
      const RowOfPairs far = row_at(y, z);
      write_fours(near, far, to + row * (y - 1));
      near = far;
    }
    write_fours(near, near, to + row * (until.y - 1));
  }
}

/// Writes the fours of a cube as write_cube() does. Along each axis the cube's first voxel lies one to three
/// voxels behind a leaf's first voxel. Precondition: the three leaves along each axis lie within the
/// universe.
void write_leaves(const GreyOctree& grey, const glm::ivec3& first, const glm::ivec3& from,
                  const glm::ivec3& until, std::uint64_t* fours) {
  const glm::ivec3 first_brick = first >> 4;
  std::array<const GreyBrick*, 8> bricks;
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 last = first + (row - 1) * glm::ivec3(i & 1, (i >> 1) & 1, i >> 2);
    bricks[static_cast<std::size_t>(i)] = &grey.brick(last >> 4);
  }
  const glm::ivec3 skipped = first & 3;
  std::array<const std::int16_t*, 27> leaves;
  std::size_t next = 0;
  for (int z = 0; z < 3; ++z)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) {
        const glm::ivec3 leaf = (first >> 2) + glm::ivec3(x, y, z);
        const glm::ivec3 place = leaf & 3, brick = (leaf >> 2) - first_brick;
        const auto number = static_cast<std::size_t>(child_index(place.x, place.y, place.z));
        leaves[next++] =
            bricks[static_cast<std::size_t>(brick.x + 2 * brick.y + 4 * brick.z)]->samples[number].data();
      }
  const int low = 16 * skipped.x, high = 64 - low;
  const auto row_at = [&](int y, int z) {
    const int in_y = y + skipped.y, in_z = z + skipped.z;
    const std::int16_t* const* const leaf =
        &leaves[static_cast<std::size_t>(3 * (in_y >> 2) + 9 * (in_z >> 2))];
    const std::uint64_t middle = row_of(leaf[1], in_y, in_z);
    return RowOfPairs((row_of(leaf[0], in_y, in_z) >> low) | (middle << high),
                      (middle >> low) | (row_of(leaf[2], in_y, in_z) << high));
  };
  write_cube(from, until, row_at, fours);
}

}  // namespace

LeafSurface::LeafSurface(const DrawnObject& object, const glm::dvec3& per_mm, const Mirror& mirror)
    : grey_(*object.grey),
      mirror_(mirror),
      still_from_voxel_(object.still_from_voxel()),
      per_mm_(still_from_voxel_ ? glm::dmat3(*still_from_voxel_) * per_mm : per_mm),
      half_voxel_mm_(static_cast<float>(0.5 / glm::length(per_mm_))),
      threshold_(static_cast<float>(object.grey->in_steps(object.threshold))),
      universe_side_(object.grey->universe().side()) {
  // Along a mirrored axis, voxels in front of the leaf have larger indices.
  for (int axis = 0; axis < 3; ++axis) {
    const int unused = side - 5 - in_front(per_mm_[axis] / glm::length(per_mm_));
    (mirror.flipped[axis] != 0 ? until_ : from_)[axis] += mirror.flipped[axis] != 0 ? -unused : unused;
  }
}

void LeafSurface::go_to(const glm::ivec3& leaf) {
  leaf_ = leaf;
  native_ = mirror_.native(leaf + 3 * mirror_.flipped);
  first_ = native_ - 3 + 2 * mirror_.flipped;
  const glm::ivec3 end = first_ + side;
  if (glm::all(glm::greaterThanEqual(first_, glm::ivec3(0))) &&
      glm::all(glm::lessThanEqual(end, glm::ivec3(universe_side_)))) {
    write_leaves(grey_, first_, from_, until_, fours_.data());
    return;
  }
  const auto row_at = [&](int y, int z) {
    std::array<std::int16_t, side> samples;
    for (int x = 0; x < side; ++x) {
      const glm::ivec3 at = first_ + glm::ivec3(x, y, z);
      const bool inside = std::min({at.x, at.y, at.z}) >= 0 && std::max({at.x, at.y, at.z}) < universe_side_;
      samples[static_cast<std::size_t>(x)] = inside ? grey_.sample(at) : beyond;
    }
    return RowOfPairs(load<std::uint64_t>(samples.data()), load<std::uint64_t>(samples.data() + 4));
  };
  write_cube(from_, until_, row_at, fours_.data());
}

void LeafSurface::find(const RayBatch& batch, Found& found) {
  const Way way{{per_mm_.x, per_mm_.y, per_mm_.z}, half_voxel_mm_, threshold_};
  alignas(64) RayBatch::ByRay<std::int32_t> kind;
  if (still_from_voxel_) {
    const StillSamples samples{&grey_, *still_from_voxel_};
    find_moved(way, samples, batch, found.depth_mm.data(), kind.data());
  } else {
    if (batch.leaf != leaf_) go_to(batch.leaf);
    Leaf leaf;
    leaf.fours = fours_.data();
    for (int axis = 0; axis < 3; ++axis) {
      leaf.first[axis] = Int{} + first_[axis];
      leaf.low_cell[axis] = Int{} + std::max(first_[axis] + from_[axis], 0);
      leaf.high_cell[axis] = Int{} + std::min(first_[axis] + until_[axis], universe_side_) - 2;
    }
    // Along a mirrored axis voxels are counted down.
    const glm::ivec3 stride = glm::ivec3(1, row, layer) * (1 - 2 * mirror_.flipped);
    const glm::ivec3 corner = native_ - first_ + 3 * mirror_.flipped;
    leaf.corner = corner.x + row * corner.y + layer * corner.z;
    for (int axis = 0; axis < 3; ++axis) leaf.stride[axis] = stride[axis];
    find_in_leaf(way, leaf, batch, found.depth_mm.data(), kind.data());
  }
  found.lit = found.stepped = 0;
  for (int i = 0; i < batch.count; ++i) {
    found.lit |= RayBatch::Rays{kind[static_cast<std::size_t>(i)] != nothing} << i;
    found.stepped |= RayBatch::Rays{kind[static_cast<std::size_t>(i)] == face} << i;
  }
}

}  // namespace octotomy::voxel
