// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Scans the head's closed forms.
// 1 The lattice covers head_bounds(), tilted or not.
// 2 Blocks of up to 4^3 voxels prune the solids of their brick to those that matter in the block. A field
//   whose value exceeds the distance from the centre to the farthest sample is decided for the whole block.
// 3 A voxel near a surface is halved three times along each axis. A part whose fields are decided counts at
//   once. Any other part after the third halving is one sample at its centre. The count equals that of 8^3
//   samples, because no decided part holds a surface.
// 4 Blur, noise, rounding.

#include "verify/phantom/head_phantom.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "verify/phantom/head_solids.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::verify {
namespace {

enum Tissue { AirTissue, HeadrestTissue, ToothTissue, BoneTissue, SoftTissue, tissue_count };
using TissueCount = std::array<int, tissue_count>;

using Places = HeadBricks::Places;
// The fields that determine a sample's tissue, in the order in which they are tested.
constexpr std::array scanned{HeadBricks::Skin, HeadBricks::Headrest, HeadBricks::Air, HeadBricks::ToothCore,
                             HeadBricks::Bone};

// The tissue at a ball, or none if it depends on an undecided field. Fields are tested one by one and not in
// a loop, because the function runs for every sample.
inline std::optional<Tissue> tissue(const Places& places) {
  if (places[HeadBricks::Skin] == 0) {
    if (places[HeadBricks::Headrest] < 0) return std::nullopt;
    return places[HeadBricks::Headrest] == 1 ? HeadrestTissue : AirTissue;
  }
  if (places[HeadBricks::Skin] < 0 || places[HeadBricks::Air] < 0) return std::nullopt;
  if (places[HeadBricks::Air] == 1) return AirTissue;
  if (places[HeadBricks::ToothCore] < 0) return std::nullopt;
  if (places[HeadBricks::ToothCore] == 1) return ToothTissue;
  if (places[HeadBricks::Bone] < 0) return std::nullopt;
  return places[HeadBricks::Bone] == 1 ? BoneTissue : SoftTissue;
}

class Scanner {
 public:
  explicit Scanner(const voxel::Lattice& lattice) : lattice_(lattice), edges_(lattice.lps_from_voxel) {
    for (const glm::dvec3& side : {glm::dvec3(1, 1, 1), {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}})
      half_diagonal_mm_ = std::max(half_diagonal_mm_, 0.5 * glm::length(edges_ * side));
  }

  // Edge in voxels of the blocks that are pruned together: the largest that fits the margin of the bricks.
  int block_side() const {
    return std::clamp(static_cast<int>(HeadBricks::margin_mm / half_diagonal_mm_), 1, 4);
  }

  // Calls store(voxel, tissues of its 512 samples) for all voxels of the block.
  template <class Store>
  void scan_block(const glm::ivec3& first, const glm::ivec3& end, const Store& store) const {
    const glm::dvec3 centre_mm = lattice_.lps_mm(glm::dvec3(first + end - 1) * 0.5);
    const glm::ivec3 size = end - first;
    const double radius_mm = reach_mm(std::max({size.x, size.y, size.z}));
    HeadBricks::Fields pruned;
    const Places places = pruned_places(centre_mm, radius_mm, pruned);
    const std::optional<Tissue> everywhere = tissue(places);
    for (int z = first.z; z < end.z; ++z)
      for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
          TissueCount count{};
          if (everywhere)
            count[*everywhere] = samples_per_voxel;
          else
            scan_voxel(lattice_.lps_mm({x, y, z}), places, pruned, count);
          store(glm::ivec3(x, y, z), count);
        }
  }

  static constexpr int halvings = 3;
  static constexpr int samples_per_voxel = 1 << (3 * halvings);

 private:
  // The distance from a cube's centre to the samples nearest its corners. `edge` is the cube's edge in
  // voxels. Samples lie at the centres of cubes with the edge 2^-halvings.
  double reach_mm(double edge) const { return half_diagonal_mm_ * (edge - 1.0 / (1 << halvings)); }

  using Halvings = std::array<HeadBricks::Fields, halvings>;

  static Places pruned_places(const glm::dvec3& centre_mm, double radius_mm, HeadBricks::Fields& pruned) {
    const HeadBricks::Brick& brick = HeadBricks::instance().at(centre_mm, radius_mm);
    Places places = brick.places;
    narrow(centre_mm, radius_mm, brick.steps, places, pruned);
    return places;
  }

  void scan_voxel(const glm::dvec3& centre_mm, Places places, const HeadBricks::Fields& block,
                  TissueCount& count) const {
    thread_local Halvings pruned;
    narrow(centre_mm, reach_mm(1.0), block, places, pruned[0]);
    halve(centre_mm, 0, places, pruned, count);
  }

  // Prunes undecided fields to a smaller ball, one after the other, until the tissue is decided.
  static void narrow(const glm::dvec3& centre_mm, double radius_mm, const HeadBricks::Fields& fields,
                     Places& places, HeadBricks::Fields& pruned) {
    for (const HeadBricks::Field field : scanned) {
      if (tissue(places)) return;
      if (places[field] < 0)
        places[field] = place(prune(fields[field], centre_mm, radius_mm, pruned[field]), radius_mm);
    }
  }

  // Counts the tissues of a part of a voxel. pruned[level] has the steps for this part. Overwrites the steps
  // of the next level for each octant.
  void halve(const glm::dvec3& centre_mm, int level, const Places& places, Halvings& pruned,
             TissueCount& count) const {
    if (const std::optional<Tissue> found = tissue(places)) {
      count[*found] += samples_per_voxel >> (3 * level);
      return;
    }
    const HeadBricks::Fields& fields = pruned[static_cast<std::size_t>(level)];
    const double size = std::ldexp(1.0, -level - 1);
    for (int octant = 0; octant < 8; ++octant) {
      const glm::dvec3 side(octant & 1, (octant >> 1) & 1, octant >> 2);
      const glm::dvec3 p_mm = centre_mm + edges_ * ((side - 0.5) * size);
      Places inner = places;
      if (level + 1 < halvings) {
        narrow(p_mm, reach_mm(size), fields, inner, pruned[static_cast<std::size_t>(level) + 1]);
        halve(p_mm, level + 1, inner, pruned, count);
      } else {
        for (const HeadBricks::Field field : scanned) {
          if (tissue(inner)) break;
          if (inner[field] < 0) inner[field] = static_cast<signed char>(value(fields[field], p_mm) < 0.0);
        }
        ++count[*tissue(inner)];
      }
    }
  }

  voxel::Lattice lattice_;
  glm::dmat3 edges_;
  double half_diagonal_mm_ = 0.0;
};

// The lattice of a scan, which covers head_bounds(). Rows and columns lie in the slices, which are turned
// about x by the tilt. Slices follow each other along the table, z, so a tilted lattice is sheared.
voxel::Lattice scan_lattice(const HeadOptions& options) {
  const voxel::Box box = head_bounds();
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  const double tilt = glm::radians(options.gantry_tilt_deg);
  const double slice_mm = options.slice_mm.value_or(options.voxel_mm);
  const double along_mm = extent_mm.y / std::cos(tilt);
  const double table_mm = extent_mm.z + extent_mm.y * std::abs(std::tan(tilt));
  // Without the millionth, rounding could add a voxel to an extent of a whole number of voxels.
  const auto count = [](double length_mm, double step_mm) {
    return static_cast<int>(std::ceil(length_mm / step_mm - 1e-6));
  };
  voxel::Lattice lattice;
  lattice.dims = {count(extent_mm.x, options.voxel_mm), count(along_mm, options.voxel_mm),
                  count(table_mm, slice_mm)};
  lattice.lps_from_voxel[0] = {options.voxel_mm, 0, 0, 0};
  lattice.lps_from_voxel[1] = glm::dvec4(0, std::cos(tilt), std::sin(tilt), 0) * options.voxel_mm;
  lattice.lps_from_voxel[2] = {0, 0, slice_mm, 0};
  const glm::dvec3 middle(glm::dvec3(lattice.dims - 1) * 0.5);
  const glm::dvec3 first_mm = (box.low_mm + box.high_mm) * 0.5 - glm::dmat3(lattice.lps_from_voxel) * middle;
  lattice.lps_from_voxel[3] = glm::dvec4(first_mm, 1.0);
  return lattice;
}

void check_options(const HeadOptions& options) {
  const auto refuse = [](const std::string& what, double value) {
    throw voxel::InvalidInput("head phantom: " + what + ", not " + voxel::rounded(value));
  };
  const double slice_mm = options.slice_mm.value_or(options.voxel_mm);
  if (!(options.voxel_mm > 0.0)) refuse("voxel_mm must be positive", options.voxel_mm);
  if (!(slice_mm > 0.0)) refuse("slice_mm must be positive", slice_mm);
  if (!(std::abs(options.gantry_tilt_deg) <= 45.0))
    refuse("gantry_tilt_deg must lie within 45 degrees", options.gantry_tilt_deg);
  if (!(options.point_spread_sigma_mm >= 0.0) || !std::isfinite(options.point_spread_sigma_mm))
    refuse("point_spread_sigma_mm must not be negative", options.point_spread_sigma_mm);
  if (!(options.noise_sigma_hu >= 0.0) || !std::isfinite(options.noise_sigma_hu))
    refuse("noise_sigma_hu must not be negative", options.noise_sigma_hu);
  // 2^31 samples would take 8 GB as floats, which no use of the phantom needs.
  const voxel::Box box = head_bounds();
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  if (extent_mm.x / options.voxel_mm * (extent_mm.y / options.voxel_mm) * (extent_mm.z / slice_mm) >
      2147483648.0)
    refuse("more than 2^31 voxels; voxel_mm is too small", options.voxel_mm);
}

voxel::FloatSamples scanned_samples(const voxel::Lattice& lattice, const HeadTissues& tissues,
                                    const voxel::Progress& progress) {
  std::array<double, tissue_count> hounsfield{};
  hounsfield[AirTissue] = tissues.air;
  hounsfield[HeadrestTissue] = tissues.headrest;
  hounsfield[ToothTissue] = tissues.tooth_core;
  hounsfield[BoneTissue] = tissues.bone;
  hounsfield[SoftTissue] = tissues.soft;
  const Scanner scanner(lattice);
  voxel::FloatSamples samples(lattice.sample_count());
  const int block = scanner.block_side();
  const glm::ivec3 blocks = (lattice.dims + block - 1) / block;
  voxel::SharedProgress rows_done(progress, static_cast<std::size_t>(blocks.z * blocks.y));
  tbb::parallel_for(0, blocks.z * blocks.y, [&](int row) {
    rows_done.one_more();
    for (int x = 0; x < blocks.x; ++x) {
      const glm::ivec3 first = glm::ivec3(x, row % blocks.y, row / blocks.y) * block;
      scanner.scan_block(first, glm::min(first + block, lattice.dims),
                         [&](const glm::ivec3& voxel, const TissueCount& count) {
                           double sum = 0.0;
                           for (std::size_t i = 0; i < tissue_count; ++i) sum += hounsfield[i] * count[i];
                           const auto index =
                               (static_cast<std::size_t>(voxel.z) * static_cast<std::size_t>(lattice.dims.y) +
                                static_cast<std::size_t>(voxel.y)) *
                                   static_cast<std::size_t>(lattice.dims.x) +
                               static_cast<std::size_t>(voxel.x);
                           samples[index] = static_cast<float>(sum / Scanner::samples_per_voxel);
                         });
    }
  });
  return samples;
}

// Blurs by a Gaussian along one axis of the lattice. The Gaussian is cut off at 5 sigma, where a step of 4000
// HU contributes about a thousandth of a Hounsfield unit. Beyond the border the border's sample repeats.
void blur_axis(voxel::FloatSamples& samples, const glm::ivec3& dims, int axis, double sigma_voxels) {
  const int reach = static_cast<int>(std::ceil(5.0 * sigma_voxels));
  const int tap_count = 2 * reach + 1;
  std::vector<double> weights(static_cast<std::size_t>(tap_count));
  double sum = 0.0;
  for (int tap = 0; tap < tap_count; ++tap) {
    const int i = tap - reach;
    // The mean of the Gaussian over a voxel, so that weights are also right for a sigma below one voxel.
    const auto below = [&](double t) { return std::erf(t / (sigma_voxels * glm::root_two<double>())); };
    const double weight = below(i + 0.5) - below(i - 0.5);
    weights[static_cast<std::size_t>(tap)] = weight;
    sum += weight;
  }
  std::size_t stride = 1;
  for (int lower = 0; lower < axis; ++lower) stride *= static_cast<std::size_t>(dims[lower]);
  const auto length = static_cast<std::size_t>(dims[axis]);
  const std::size_t line_count = samples.size() / length;
  tbb::parallel_for(std::size_t{0}, line_count, [&](std::size_t line) {
    float* const begin = samples.data() + line / stride * stride * length + line % stride;
    voxel::FloatSamples copy(length);
    for (std::size_t i = 0; i < length; ++i) copy[i] = begin[i * stride];
    for (int i = 0; i < dims[axis]; ++i) {
      double mean = 0.0;
      for (int tap = 0; tap < tap_count; ++tap) {
        const int from = std::clamp(i + tap - reach, 0, dims[axis] - 1);
        mean += weights[static_cast<std::size_t>(tap)] *
                static_cast<double>(copy[static_cast<std::size_t>(from)]);
      }
      begin[static_cast<std::size_t>(i) * stride] = static_cast<float>(mean / sum);
    }
  });
}

// A counter-based generator: the value depends only on the seed and the sample's index, not on the thread.
// Source: the finaliser of SplitMix64 (Steele, Lea, Flood 2014), twice.
std::uint64_t scrambled(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// A random number from the standard normal distribution by Box and Muller's transform.
double normal_deviate(std::uint64_t seed, std::uint64_t index) {
  const std::uint64_t first = scrambled(scrambled(seed) ^ index);
  const std::uint64_t second = scrambled(first);
  // 53 bits each; the first is never zero.
  const double u = (static_cast<double>(first >> 11) + 1.0) * 0x1p-53;
  const double v = static_cast<double>(second >> 11) * 0x1p-53;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(glm::two_pi<double>() * v);
}

}  // namespace

voxel::Box head_bounds() {
  // The bounds and the coordinates of the middle of the box are even. So the voxels of a scan that is not
  // tilted are also voxels of a universe with the same spacing of 1 or 2 mm. Planes at whole millimetres (at
  // 2 mm: even ones) lie between voxels.
  return {{-100, -122, -136}, {100, 126, 116}};
}

bool head_contains(HeadPart part, const glm::dvec3& p_mm) {
  HeadBricks::Field field = HeadBricks::Bone;
  if (part == HeadPart::Mandible) field = HeadBricks::Mandible;
  if (part == HeadPart::Teeth) field = HeadBricks::Teeth;
  if (part == HeadPart::Skin) field = HeadBricks::Skin;
  const HeadBricks::Brick& brick = HeadBricks::instance().at(p_mm);
  if (brick.places[field] >= 0) return brick.places[field] == 1;
  // Successive points are often neighbours. The last value decides a ball around its point; another point
  // within this ball is on the same side of the surface.
  struct LastAsked {
    glm::dvec3 p_mm{0.0};
    double value = 0.0;
  };
  thread_local std::array<LastAsked, HeadBricks::field_count> last_of;
  LastAsked& last = last_of[field];
  if (const signed char there = place(last.value, glm::distance(p_mm, last.p_mm)); there >= 0)
    return there == 1;
  last = {p_mm, value(brick.steps[field], p_mm)};
  return last.value < 0.0;
}

voxel::Scene head_phantom(const HeadOptions& options, const voxel::Progress& progress) {
  check_options(options);
  voxel::Scene scene;
  scene.lattice = scan_lattice(options);
  scene.meaning = voxel::Meaning::Hounsfield;
  scene.modality = "CT";
  scene.source = "head phantom";
  voxel::FloatSamples samples =
      scanned_samples(scene.lattice, options.tissues, voxel::part_of(progress, 0.0, 0.8));
  if (options.point_spread_sigma_mm > 0.0)
    for (int axis = 0; axis < 3; ++axis) {
      progress.at(0.8 + 0.05 * axis);
      blur_axis(samples, scene.lattice.dims, axis,
                options.point_spread_sigma_mm / scene.lattice.spacing_mm()[axis]);
    }
  voxel::Int16Samples rounded(samples.size());
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t i) {
    double sample = samples[i];
    if (options.noise_sigma_hu > 0.0) sample += options.noise_sigma_hu * normal_deviate(options.seed, i);
    constexpr double low = std::numeric_limits<std::int16_t>::min();
    constexpr double high = std::numeric_limits<std::int16_t>::max();
    rounded[i] = static_cast<std::int16_t>(std::clamp(std::round(sample), low, high));
  });
  scene.samples = std::move(rounded);
  return scene;
}

}  // namespace octotomy::verify
