// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/resample_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "voxel/filter/slice_work.h"
#include "voxel/measure/distance_map.h"
#include "voxel/space/error.h"
#include "voxel/space/memory_need.h"
#include "voxel/tree/interpolate.h"

namespace octotomy::voxel {
namespace {

// The position of a slice of the result, in slices of the scene. A position that is an integer except for
// rounding errors becomes exactly that integer, so that sampled slices remain unchanged.
double place_of(int slice, double spacing_mm, double from_mm) {
  const double place = slice * (spacing_mm / from_mm);
  const double whole = std::round(place);
  // The quotient, the product and the spacing are rounded, together by at most four parts in 2^52 per slice.
  return std::abs(place - whole) <= 4.0 * std::numeric_limits<double>::epsilon() * (1.0 + place) ? whole
                                                                                                 : place;
}

struct Weights {
  int first = 0;
  int count = 1;
  std::array<double, 6> weight{1.0};
};

double sinc(double x) {
  return x == 0.0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

Weights weights_of(double place, SliceKernel kernel) {
  const double cell = std::floor(place);
  // At an integer position the result is a copy of the sampled slice, because every kernel is 1 at 0 and 0 at
  // other integers.
  if (place == cell) return {static_cast<int>(cell), 1, {1.0}};
  Weights result;
  if (kernel != SliceKernel::Lanczos) {
    const Stencil of = stencil(place, kernel == SliceKernel::Nearest  ? Interpolation::Nearest
                                      : kernel == SliceKernel::Linear ? Interpolation::Linear
                                                                      : Interpolation::Cubic);
    result.first = of.first;
    result.count = of.count;
    std::copy_n(of.weight.begin(), of.count, result.weight.begin());
    return result;
  }
  result.first = static_cast<int>(cell) - 2;
  result.count = 6;
  double sum = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double x = place - (result.first + i);
    const double weight = std::abs(x) < 3.0 ? sinc(x) * sinc(x / 3.0) : 0.0;
    result.weight[static_cast<std::size_t>(i)] = weight;
    sum += weight;
  }
  for (double& weight : result.weight) weight /= sum;
  return result;
}

// For each sample of one slice, the distance in mm to the outline of the window's object, negative inside;
// empty if the object has no sample in the slice.
std::vector<float> slice_distances(const Scene& scene, int k, const ShapeOptions& options) {
  const glm::ivec3 dims(scene.lattice.dims.x, scene.lattice.dims.y, 1);
  const VoxelRange range{glm::ivec3(0), dims - 1};
  const std::size_t size = slice_size(scene.lattice);
  constexpr float far_away = std::numeric_limits<float>::infinity();
  DistanceMap to_inside{range, std::vector<float>(size, far_away)};
  // A frame of one pixel represents everything beyond the slice, which is outside.
  const VoxelRange framed{{-1, -1, 0}, {dims.x, dims.y, 0}};
  DistanceMap to_outside{
      framed, std::vector<float>(
                  (static_cast<std::size_t>(dims.x) + 2) * (static_cast<std::size_t>(dims.y) + 2), 0.0F)};
  bool any = false;
  const double low = above_padding(scene, options.low);
  std::visit(
      [&](const auto& samples) {
        for (int y = 0; y < dims.y; ++y)
          for (int x = 0; x < dims.x; ++x) {
            const std::size_t at = to_inside.index({x, y, 0});
            const auto sample = static_cast<double>(samples[static_cast<std::size_t>(k) * size + at]);
            if (sample < low || sample > options.high) continue;
            any = true;
            to_inside.square_mm2[at] = 0.0F;
            to_outside.square_mm2[to_outside.index({x, y, 0})] = far_away;
          }
      },
      scene.samples);
  if (!any) return {};
  const Universe pixels{2, scene.lattice.lps_from_voxel};
  spread(to_inside, pixels);
  spread(to_outside, pixels);
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const double half_mm = 0.5 * std::min(spacing_mm.x, spacing_mm.y);
  std::vector<float> distances(size);
  for (int y = 0; y < dims.y; ++y)
    for (int x = 0; x < dims.x; ++x) {
      const std::size_t at = to_inside.index({x, y, 0});
      const double out_mm = std::sqrt(static_cast<double>(to_inside.square_mm2[at]));
      const double in_mm = std::sqrt(static_cast<double>(to_outside.square_mm2[to_outside.index({x, y, 0})]));
      distances[at] = static_cast<float>(out_mm > 0.0 ? out_mm - half_mm : half_mm - in_mm);
    }
  return distances;
}

}  // namespace

Lattice with_slice_spacing(const Lattice& lattice, double spacing_mm) {
  if (!(spacing_mm > 0.0) || !std::isfinite(spacing_mm))
    throw InvalidInput("the spacing of slices must be positive, not " + std::to_string(spacing_mm) + " mm");
  const double from_mm = lattice.spacing_mm().z;
  const double steps = (lattice.dims.z - 1) * (from_mm / spacing_mm);
  constexpr int most_slices = 1 << 16;
  if (steps >= most_slices)
    throw InvalidInput("slices " + std::to_string(spacing_mm) + " mm apart would be more than " +
                       std::to_string(most_slices) + ": choose a wider spacing");
  // As in place_of(), rounding must not lose the last slice.
  const double rounding = 8.0 * std::numeric_limits<double>::epsilon() * (1.0 + steps);
  Lattice result = lattice;
  result.dims.z = static_cast<int>(std::floor(steps + rounding)) + 1;
  result.lps_from_voxel[2] *= spacing_mm / from_mm;
  return result;
}

Scene resample_slices(const Scene& scene, double spacing_mm, SliceKernel kernel, const Progress& progress) {
  check(scene);
  if (scene.meaning == Meaning::Label && kernel != SliceKernel::Nearest)
    throw InvalidInput("labels cannot be interpolated: resample a label map by the nearest slice");
  Scene result = empty_scene_like(scene, with_slice_spacing(scene.lattice, spacing_mm));
  need_room(scene.source, result.lattice.sample_count(),
            std::holds_alternative<FloatSamples>(scene.samples) ? sizeof(float) : sizeof(std::int16_t));
  const double from_mm = scene.lattice.spacing_mm().z;
  const std::size_t size = slice_size(scene.lattice);
  const int last = scene.lattice.dims.z - 1;
  // Without padding this is NaN, which no sample equals. Kernels may overshoot downwards; such samples are
  // raised to `least`, which is above the padding.
  const double padding = scene.padding.value_or(std::numeric_limits<double>::quiet_NaN());
  const double least = scene.padding ? *scene.padding + std::max(1.0, 0x1p-20 * std::abs(*scene.padding))
                                     : -std::numeric_limits<double>::infinity();
  std::visit(
      [&](const auto& samples) {
        using Held = std::decay_t<decltype(samples)>;
        Held made(result.lattice.sample_count());
        for_each_slice(result.lattice.dims.z, progress, [&](int k) {
          const Weights weights =
              weights_of(std::min<double>(place_of(k, spacing_mm, from_mm), last), kernel);
          const auto out = made.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k) * size);
          std::array<const typename Held::value_type*, 6> slices{};
          for (int i = 0; i < weights.count; ++i)
            slices[static_cast<std::size_t>(i)] =
                samples.data() + static_cast<std::size_t>(std::clamp(weights.first + i, 0, last)) * size;
          for (std::size_t at = 0; at < size; ++at) {
            double value = 0.0;
            bool is_padded = false;
            for (std::size_t i = 0; i < static_cast<std::size_t>(weights.count); ++i) {
              const auto sample = static_cast<double>(slices[i][at]);
              value += weights.weight[i] * sample;
              is_padded |= sample == padding;
            }
            out[static_cast<std::ptrdiff_t>(at)] =
                rounded<typename Held::value_type>(is_padded ? padding : std::max(value, least));
          }
        });
        result.samples = std::move(made);
      },
      scene.samples);
  return result;
}

Scene interpolate_shape(const Scene& scene, const ShapeOptions& options) {
  check(scene);
  Scene result = empty_scene_like(scene, with_slice_spacing(scene.lattice, options.spacing_mm));
  result.meaning = Meaning::Label;
  result.padding.reset();
  need_room(scene.source, result.lattice.sample_count(), sizeof(std::int16_t));
  const double from_mm = scene.lattice.spacing_mm().z;
  const std::size_t size = slice_size(scene.lattice);
  const int last = scene.lattice.dims.z - 1;
  Int16Samples made(result.lattice.sample_count());
  for_each_slice(result.lattice.dims.z, options.progress, [&](int k) {
    const double place = std::min<double>(place_of(k, options.spacing_mm, from_mm), last);
    const int below = static_cast<int>(std::floor(place));
    const double t = place - below;
    const auto out = made.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(k) * size);
    std::vector<float> a = slice_distances(scene, below, options);
    std::vector<float> b = t > 0.0 ? slice_distances(scene, below + 1, options) : std::vector<float>();
    const bool between = t > 0.0 && !a.empty() && !b.empty();
    const std::vector<float>& nearer = t <= 0.5 ? a : b;
    for (std::size_t at = 0; at < size; ++at) {
      double away = 1.0;
      if (between)
        away = (1.0 - t) * static_cast<double>(a[at]) + t * static_cast<double>(b[at]);
      else if (!nearer.empty())
        away = static_cast<double>(nearer[at]);
      out[static_cast<std::ptrdiff_t>(at)] = away <= 0.0 ? 1 : 0;
    }
  });
  result.samples = std::move(made);
  return result;
}

}  // namespace octotomy::voxel
