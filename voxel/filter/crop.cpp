// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/crop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>

#include "voxel/filter/slice_work.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

// A copy of a scene without samples. Its index 0 lies at index `first_voxel` of the other scene.
Scene empty_part(const Scene& scene, const glm::ivec3& dims, const glm::dvec3& first_voxel) {
  Lattice lattice{dims, scene.lattice.lps_from_voxel};
  lattice.lps_from_voxel[3] = glm::dvec4(scene.lattice.lps_mm(first_voxel), 1.0);
  return empty_scene_like(scene, lattice);
}

std::string text_of(const glm::ivec3& v) {
  return std::to_string(v.x) + "," + std::to_string(v.y) + "," + std::to_string(v.z);
}

}  // namespace

VoxelRange range_within(const Lattice& lattice, const Box& box) {
  // A tolerance in voxels, far above rounding errors, so that a centre on the box's face counts as inside.
  constexpr double rounding = 1e-3;
  VoxelRange range{glm::ivec3(0), lattice.dims - 1};
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p_mm =
        glm::mix(box.low_mm, box.high_mm, glm::dvec3(corner & 1, (corner >> 1) & 1, corner >> 2));
    const glm::dvec3 p_voxel = lattice.voxel(p_mm);
    low = glm::min(low, p_voxel);
    high = glm::max(high, p_voxel);
  }
  low = glm::clamp(low, glm::dvec3(-1.0), glm::dvec3(lattice.dims));
  high = glm::clamp(high, glm::dvec3(-1.0), glm::dvec3(lattice.dims));
  range.low = glm::max(range.low, glm::ivec3(glm::ceil(low - rounding)));
  range.high = glm::min(range.high, glm::ivec3(glm::floor(high + rounding)));
  return range;
}

Scene crop(const Scene& scene, const VoxelRange& range) {
  check(scene);
  if (range.is_empty() || glm::any(glm::lessThan(range.low, glm::ivec3(0))) ||
      glm::any(glm::greaterThanEqual(range.high, scene.lattice.dims)))
    throw InvalidInput("the part " + text_of(range.low) + " to " + text_of(range.high) +
                       " is empty or leaves the scan of " + text_of(scene.lattice.dims) + " samples");
  const glm::ivec3 dims = range.dims();
  Scene part = empty_part(scene, dims, glm::dvec3(range.low));
  std::visit(
      [&](const auto& samples) {
        std::decay_t<decltype(samples)> kept(part.lattice.sample_count());
        tbb::parallel_for(0, dims.z, [&](int z) {
          for (int y = 0; y < dims.y; ++y)
            std::copy_n(&samples[sample_index(scene.lattice.dims, range.low + glm::ivec3(0, y, z))], dims.x,
                        &kept[sample_index(dims, {0, y, z})]);
        });
        part.samples = std::move(kept);
      },
      scene.samples);
  return part;
}

Scene average_down(const Scene& scene, const glm::ivec3& factor, const Progress& progress) {
  check(scene);
  if (glm::any(glm::lessThan(factor, glm::ivec3(1))))
    throw InvalidInput("averaging requires 1 or more samples along each axis, not " + text_of(factor));
  if (scene.meaning == Meaning::Label)
    throw InvalidInput("labels have no mean, so a label map cannot be averaged down");
  const glm::ivec3 from = scene.lattice.dims;
  const glm::ivec3 dims = (from + factor - 1) / factor;
  Scene result = empty_part(scene, dims, 0.5 * glm::dvec3(factor - 1));
  for (int axis = 0; axis < 3; ++axis)
    result.lattice.lps_from_voxel[axis] *= static_cast<double>(factor[axis]);
  std::visit(
      [&](const auto& samples) {
        using Held = std::decay_t<decltype(samples)>;
        Held means(result.lattice.sample_count());
        const auto mean = [&](const glm::ivec3& block) {
          const glm::ivec3 low = block * factor;
          const glm::ivec3 high = glm::min(low + factor, from);
          double sum = 0.0;
          for (int z = low.z; z < high.z; ++z)
            for (int y = low.y; y < high.y; ++y)
              for (int x = low.x; x < high.x; ++x) {
                const auto sample = samples[sample_index(from, {x, y, z})];
                if (scene.padding && static_cast<double>(sample) == *scene.padding) return sample;
                sum += static_cast<double>(sample);
              }
          const glm::ivec3 size = high - low;
          return rounded<typename Held::value_type>(sum / (static_cast<double>(size.x) * size.y * size.z));
        };
        for_each_slice(dims.z, progress, [&](int z) {
          for (int y = 0; y < dims.y; ++y)
            for (int x = 0; x < dims.x; ++x) means[sample_index(dims, {x, y, z})] = mean({x, y, z});
        });
        result.samples = std::move(means);
      },
      scene.samples);
  return result;
}

}  // namespace octotomy::voxel
