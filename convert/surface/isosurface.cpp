// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/isosurface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <utility>

#include "convert/surface/surface_extraction.h"
#include "convert/surface/window_surface.h"
#include "voxel/space/error.h"
#include "voxel/tree/octree_node.h"
#include "voxel/tree/window_bits.h"

namespace octotomy::convert {
namespace {

/// The least distance of a crossing from a sample, as a part of the edge. Without it, a sample equal to a
/// bound would collapse up to six vertices into one point and triangles to nothing. The value is half the way
/// that a crossing moves if a sample changes by 1, on an edge whose ends differ by 512: the rounding of the
/// samples makes a crossing from soft tissue to bone equally uncertain. The bias is of second order: only
/// this share of the crossings moves, each by at most this share of an edge.
constexpr double closest_to_sample() {
  return 0.5 / 512.0;
}

/// The part of an edge, from the first sample, at which the line between its samples leaves the window. A
/// sample that is not a number is outside; the crossing beside it is half way.
double crossing(double first, double second, bool first_inside, double low, double high) {
  const double outside = first_inside ? second : first;
  const double bound = outside > high ? high : low;
  const double t = (bound - first) / (second - first);
  if (std::isnan(t)) return 0.5;
  return std::clamp(t, closest_to_sample(), 1.0 - closest_to_sample());
}

/// The crossing of the lower bound or, if `is_upper`, of the upper one. On an edge that crosses both bounds,
/// the two crossings are at least closest_to_sample() apart. On other edges as crossing().
double crossing_of_two(double first, double second, bool first_inside, double low, double high,
                       bool is_upper) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double from = std::min(first, second), to = std::max(first, second);
  if (!(from < low && to > high))
    return crossing(first, second, first_inside, is_upper ? high : low, infinity);
  const auto part = [&](double bound) {
    const double t = (bound - from) / (to - from);
    return std::isnan(t) ? 0.5 : t;
  };
  const double least = closest_to_sample();
  double t = std::clamp(part(low), least, 1.0 - 2.0 * least);
  if (is_upper) t = std::clamp(part(high), t + least, 1.0 - least);
  return first < second ? t : 1.0 - t;
}

/// Eight flags of one byte each, the first in the lowest byte, as eight bits.
std::uint64_t packed(std::uint64_t flags) {
  return (flags * 0x0102040810204080ULL) >> 56;
}

/// Sets the bits of one row of samples, shifted by one place for the padding.
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

/// The samples of a scene.
template <typename Sample>
class SceneSamples {
 public:
  SceneSamples(const voxel::Lattice& lattice, const voxel::Samples<Sample>& samples,
               std::optional<double> padding)
      : lattice_(lattice), samples_(samples), padding_(padding) {}
  const voxel::Lattice& lattice() const { return lattice_; }

  InsideBits measured() const {
    const double lowest = padding_ ? std::nextafter(*padding_, std::numeric_limits<double>::infinity())
                                   : -std::numeric_limits<double>::infinity();
    return inside(lowest, std::numeric_limits<double>::infinity());
  }

  InsideBits inside(double low, double high) const {
    InsideBits bits(lattice_.dims, 1);
    if constexpr (std::is_integral_v<Sample>) {
      if (const std::optional<voxel::Window16> window = voxel::window16(low, high))
        mark_all(
            samples_, lattice_.dims, [w = *window](std::int16_t v) { return (v >= w.low) & (v <= w.high); },
            bits);
    } else {
      mark_all(
          samples_, lattice_.dims,
          [=](float v) { return (static_cast<double>(v) >= low) & (static_cast<double>(v) <= high); }, bits);
    }
    return bits;
  }

  /// The samples at a voxel and at the next one along an axis.
  std::pair<double, double> two(const glm::ivec3& voxel, int axis) const {
    const auto nx = static_cast<std::size_t>(lattice_.dims.x);
    const auto ny = static_cast<std::size_t>(lattice_.dims.y);
    const std::array<std::size_t, 3> step = {1, nx, nx * ny};
    const std::size_t index = static_cast<std::size_t>(voxel.x) + nx * static_cast<std::size_t>(voxel.y) +
                              nx * ny * static_cast<std::size_t>(voxel.z);
    return {measured(index), measured(index + step[static_cast<std::size_t>(axis)])};
  }

 private:
  /// NaN for padding, so that the surface closes at the end of the measured voxel.
  double measured(std::size_t index) const {
    const auto sample = static_cast<double>(samples_[index]);
    return padding_ && sample == *padding_ ? std::numeric_limits<double>::quiet_NaN() : sample;
  }

  const voxel::Lattice& lattice_;
  const voxel::Samples<Sample>& samples_;
  std::optional<double> padding_;
};

/// The samples of a grey octree: skips blocks that are wholly inside or outside the window.
class GreySamples {
 public:
  explicit GreySamples(const voxel::GreyOctree& grey) : grey_(grey), lattice_(grey.universe().lattice()) {}
  const voxel::Lattice& lattice() const { return lattice_; }

  InsideBits measured() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return inside(-infinity, infinity);
  }

  /// Once a window contained the background, samples beyond the scan count as not measured, also in later
  /// calls.
  InsideBits inside(double low, double high) {
    InsideBits bits(lattice_.dims, 16);
    const std::optional<voxel::Window16> window = voxel::window16(low, high);
    if (!window) return bits;
    meets_background_ = meets_background_ || grey_.window_meets_background(low, high);
    const int blocks = (lattice_.dims.x + 15) / 16;
    tbb::parallel_for(0, blocks, [&](int z) {
      for (int y = 0; y < blocks; ++y)
        for (int x = 0; x < blocks; ++x) mark_block({x, y, z}, *window, bits);
    });
    return bits;
  }

  /// The two samples as by GreyOctree::sample(). If the window contains the background, a sample beyond the
  /// scan is NaN. Precondition: both voxels are in the universe.
  std::pair<double, double> two(const glm::ivec3& voxel, int axis) const {
    const auto [first, second] = samples_of(voxel, axis);
    if (!meets_background_) return {first, second};
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    glm::ivec3 next = voxel;
    ++next[axis];
    return {grey_.scan().contains(voxel) ? first : none, grey_.scan().contains(next) ? second : none};
  }

 private:
  std::pair<double, double> samples_of(const glm::ivec3& voxel, int axis) const {
    const glm::ivec3 in_brick = voxel & 15;
    const int place = in_brick[axis];
    const int first = (spread[in_brick.x] + (spread[in_brick.y] << 2)) + (spread[in_brick.z] << 4);
    const int second = first + ((spread[(place + 1) & 15] - spread[place]) << (2 * axis));
    const glm::ivec3 block = voxel >> 4;
    const voxel::GreyBrick& brick = grey_.brick(block);
    if (place != 15) return {sample(brick, first), sample(brick, second)};
    glm::ivec3 next = block;
    ++next[axis];
    return {sample(brick, first), sample(grey_.brick(next), second)};
  }

  static double sample(const voxel::GreyBrick& brick, int number) {
    const auto at = static_cast<std::size_t>(number);
    return brick.samples[at / 64][at % 64];
  }

  /// How much a coordinate x within a brick adds to a sample's index: bricks store their samples in leaves of
  /// 4^3.
  static constexpr std::array<int, 16> spread = {0,   1,   2,   3,   64,  65,  66,  67,
                                                 128, 129, 130, 131, 192, 193, 194, 195};

  void mark_block(const glm::ivec3& block, voxel::Window16 window, InsideBits& bits) const {
    const voxel::MinMax range = grey_.range(2, block);
    if (range.high < window.low || range.low > window.high) return;
    // The rows of sixteen samples along x, at y + 16 z.
    std::array<std::uint16_t, 256> rows{};
    const voxel::BlockRef scan = meets_background_ ? grey_.scan().leaf_block(block) : voxel::BlockRef::full();
    if (scan.is_full() && range.low >= window.low && range.high <= window.high) {
      rows.fill(0xffff);
    } else {
      const voxel::GreyBrick& brick = grey_.brick(block);
      for (std::size_t leaf = 0; leaf < 64; ++leaf) {
        const voxel::MinMax within = brick.leaf_range[leaf];
        if (within.high < window.low || within.low > window.high) continue;
        const bool all = within.low >= window.low && within.high <= window.high;
        const std::uint64_t word =
            scan.word(static_cast<int>(leaf)) &
            (all ? ~std::uint64_t{0} : voxel::window_bits64(brick.samples[leaf].data(), window));
        const std::size_t first_row = 4 * ((leaf / 4) % 4) + 64 * (leaf / 16);
        for (std::size_t row = 0; row < 16; ++row)
          rows[first_row + row % 4 + 16 * (row / 4)] |=
              static_cast<std::uint16_t>(((word >> (4 * row)) & 15) << (4 * (leaf % 4)));
      }
    }
    const glm::ivec3 origin = 16 * block;
    const glm::ivec3 count = glm::min(lattice_.dims - origin, glm::ivec3(16));
    const auto mask = static_cast<std::uint16_t>((1U << count.x) - 1);
    const int bit = origin.x + 16;
    for (int z = 0; z < count.z; ++z)
      for (int y = 0; y < count.y; ++y) {
        const std::uint64_t sixteen = rows[static_cast<std::size_t>(y + 16 * z)] & mask;
        bits.row(static_cast<std::size_t>(origin.y + y + 1),
                 static_cast<std::size_t>(origin.z + z + 1))[bit / 64] |= sixteen << (bit % 64);
      }
  }

  const voxel::GreyOctree& grey_;
  voxel::Lattice lattice_;
  bool meets_background_ = false;  ///< whether a window contained the background
};

void check_bounds(double low, double high) {
  if (std::isnan(low) || std::isnan(high))
    throw voxel::InvalidInput("isosurface: a bound of the window is not a number");
}

/// Whether any bit is set in the first that is not set in the second.
bool any_beyond(const InsideBits& first, const InsideBits& second) {
  for (std::size_t i = 0; i < first.bits.size(); ++i)
    if ((first.bits[i] & ~second.bits[i]) != 0) return true;
  return false;
}

/// The bits of a window with samples on either side of it. Returns none if one bound alone makes the surface,
/// or the window is a single value, whose level sets have nothing between them.
template <typename Samples>
std::optional<WindowBits> two_sided(Samples& samples, double low, double high) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (!(low < high) || low == -infinity || high == infinity) return std::nullopt;
  InsideBits above = samples.inside(std::nextafter(high, infinity), infinity);
  if (std::none_of(above.bits.begin(), above.bits.end(), [](std::uint64_t word) { return word != 0; }))
    return std::nullopt;
  InsideBits measured = samples.measured();
  InsideBits from_low = samples.inside(low, infinity);
  if (!any_beyond(measured, from_low)) return std::nullopt;
  return WindowBits{std::move(measured), std::move(from_low), std::move(above)};
}

/// Writes `part(first, second, first_inside)` for each edge.
template <typename Samples, typename Part>
Crossings crossings_of(const Samples& samples, const Part& part) {
  return [&samples, part](std::span<const CrossedEdge> edges, double* parts) {
    for (const CrossedEdge& edge : edges) {
      const auto [first, second] = samples.two(edge.voxel, edge.axis);
      *parts++ = part(first, second, edge.first_inside);
    }
  };
}

template <typename Samples>
brep::Triangles surface_of(Samples samples, double low, double high, const voxel::Progress& progress) {
  progress.at(0.0);
  Samples by_levels = samples;
  if (const std::optional<WindowBits> bits = two_sided(by_levels, low, high)) {
    const auto crossed_at = [&](bool is_upper) {
      return crossings_of(by_levels, [=](double first, double second, bool first_inside) {
        return crossing_of_two(first, second, first_inside, low, high, is_upper);
      });
    };
    return window_surface(samples.lattice(), *bits, crossed_at(false), crossed_at(true), progress);
  }
  const InsideBits inside = samples.inside(low, high);
  return extract_surface(samples.lattice(), inside,
                         crossings_of(samples,
                                      [=](double first, double second, bool first_inside) {
                                        return crossing(first, second, first_inside, low, high);
                                      }),
                         progress);
}

}  // namespace

brep::Triangles isosurface(const voxel::Scene& scene, double low, double high,
                           const voxel::Progress& progress) {
  check(scene);
  check_bounds(low, high);
  return std::visit(
      [&]<typename Sample>(const voxel::Samples<Sample>& samples) {
        return surface_of(SceneSamples<Sample>(scene.lattice, samples, scene.padding),
                          above_padding(scene, low), high, progress);
      },
      scene.samples);
}

brep::Triangles isosurface(const voxel::GreyOctree& grey, double low, double high,
                           const voxel::Progress& progress) {
  check_bounds(low, high);
  return surface_of(GreySamples(grey), grey.in_steps(low), grey.in_steps(high), progress);
}

bool stays_apart(const voxel::Lattice& lattice) {
  const glm::dmat3 edges(lattice.lps_from_voxel);
  const double largest_face_mm2 =
      std::max({glm::length(glm::cross(edges[0], edges[1])), glm::length(glm::cross(edges[1], edges[2])),
                glm::length(glm::cross(edges[2], edges[0]))});
  const voxel::Box box = voxel::bounds(lattice);
  const glm::dvec3 farthest_mm = glm::max(glm::abs(box.low_mm), glm::abs(box.high_mm));
  return std::max({farthest_mm.x, farthest_mm.y, farthest_mm.z}) * largest_face_mm2 <
         0x1p16 * lattice.voxel_mm3();
}

}  // namespace octotomy::convert
