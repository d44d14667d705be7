// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/tilt_correction.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tbb/parallel_for.h>
#include <type_traits>

namespace octotomy::voxel {
namespace {

template <typename Stored>
Stored interpolated(const SlicePlan& plan, const glm::ivec2& from_px, const Stored& stored,
                    std::optional<double> padding) {
  using Sample = typename Stored::value_type;
  const std::size_t from_area = static_cast<std::size_t>(from_px.x) * static_cast<std::size_t>(from_px.y);
  const std::size_t width = static_cast<std::size_t>(plan.size_px.x);
  const std::size_t area = width * static_cast<std::size_t>(plan.size_px.y);
  const std::size_t slice_count = stored.size() / from_area;
  assert(stored.size() == from_area * slice_count && !stored.empty());
  assert(plan.aside_px.empty() || plan.aside_px.size() == slice_count);
  const std::vector<glm::dvec2> aside_px =
      plan.aside_px.empty() ? std::vector<glm::dvec2>(slice_count, glm::dvec2(0.0)) : plan.aside_px;
  const double fill =
      padding ? *padding : static_cast<double>(*std::min_element(stored.begin(), stored.end()));
  // A slice ends half a pixel beyond the centres of its outer pixels.
  const auto covers = [&](const glm::dvec2& p_px) {
    return p_px.x >= -0.5 && p_px.y >= -0.5 && p_px.x <= from_px.x - 0.5 && p_px.y <= from_px.y - 0.5;
  };
  const auto in_slice = [&](std::size_t slice, glm::dvec2 p_px) {
    p_px = glm::clamp(p_px, glm::dvec2(0.0), glm::dvec2(from_px - 1));
    const glm::ivec2 low = glm::min(glm::ivec2(p_px), glm::max(from_px - 2, 0));
    const glm::dvec2 t = p_px - glm::dvec2(low);
    const auto at = [&](int x, int y) {
      const glm::ivec2 i = glm::min(low + glm::ivec2(x, y), from_px - 1);
      return static_cast<double>(
          stored[slice * from_area + static_cast<std::size_t>(i.y) * static_cast<std::size_t>(from_px.x) +
                 static_cast<std::size_t>(i.x)]);
    };
    if (padding)
      for (int corner = 0; corner < 4; ++corner) {
        const glm::ivec2 side(corner & 1, corner >> 1);
        const glm::dvec2 share = glm::mix(1.0 - t, t, glm::dvec2(side));
        if (share.x * share.y > 0.0 && at(side.x, side.y) == *padding) return *padding;
      }
    const double lower = at(0, 0) * (1.0 - t.x) + at(1, 0) * t.x;
    return t.y == 0.0 ? lower : lower * (1.0 - t.y) + (at(0, 1) * (1.0 - t.x) + at(1, 1) * t.x) * t.y;
  };
  Stored samples(area * plan.sources.size());
  tbb::parallel_for(std::size_t{0}, plan.sources.size(), [&](std::size_t k) {
    const SlicePlan::Source source = plan.sources[k];
    for (std::size_t i = 0; i < area; ++i) {
      const std::size_t column = i % width, row = i / width;
      const glm::dvec2 p_px = glm::dvec2(plan.low_px) + glm::dvec2(column, row);
      const glm::dvec2 below_px = p_px - aside_px[source.below], above_px = p_px - aside_px[source.above];
      // A mixture of a sample and the fill value is no measurement, so such samples get the fill value.
      double value = fill;
      if (covers(below_px) && covers(above_px)) {
        value = in_slice(source.below, below_px);
        const double above = source.above != source.below ? in_slice(source.above, above_px) : value;
        if (padding && (value == *padding || above == *padding))
          value = *padding;
        else
          value += source.share_above * (above - value);
      }
      if constexpr (std::is_integral_v<Sample>)
        samples[k * area + i] = static_cast<Sample>(std::floor(value + 0.5));
      else
        samples[k * area + i] = static_cast<Sample>(value);
    }
  });
  return samples;
}

}  // namespace

SceneSamples tilt_corrected_samples(const SlicePlan& plan, const glm::ivec2& slice_px,
                                    const SceneSamples& stored, std::optional<double> padding) {
  return std::visit(
      [&](const auto& samples) -> SceneSamples { return interpolated(plan, slice_px, samples, padding); },
      stored);
}

Scene tilt_corrected(const Scene& scene) {
  const glm::dmat4& axes = scene.lattice.lps_from_voxel;
  const glm::dvec3 row_mm(axes[0]), column_mm(axes[1]), step_mm(axes[2]);
  assert(std::abs(glm::dot(row_mm, column_mm)) < 1e-6 * glm::length(row_mm) * glm::length(column_mm));
  const glm::dvec2 lean_px(glm::dot(step_mm, row_mm) / glm::dot(row_mm, row_mm),
                           glm::dot(step_mm, column_mm) / glm::dot(column_mm, column_mm));
  const int slices = scene.lattice.dims.z;
  const glm::dvec2 last_px = lean_px * static_cast<double>(slices - 1);
  SlicePlan plan;
  plan.low_px = glm::ivec2(glm::floor(glm::min(last_px, 0.0)));
  plan.size_px = glm::ivec2(scene.lattice.dims) + glm::ivec2(glm::ceil(glm::max(last_px, 0.0))) - plan.low_px;
  for (int k = 0; k < slices; ++k) {
    plan.aside_px.push_back(lean_px * static_cast<double>(k));
    plan.sources.push_back({static_cast<std::size_t>(k), static_cast<std::size_t>(k), 0.0});
  }
  Scene made = scene;
  made.samples = tilt_corrected_samples(plan, glm::ivec2(scene.lattice.dims), scene.samples, scene.padding);
  made.lattice.dims = {plan.size_px, slices};
  made.lattice.lps_from_voxel[2] = glm::dvec4(step_mm - lean_px.x * row_mm - lean_px.y * column_mm, 0.0);
  made.lattice.lps_from_voxel[3] = axes * glm::dvec4(glm::dvec2(plan.low_px), 0.0, 1.0);
  return made;
}

}  // namespace octotomy::voxel
