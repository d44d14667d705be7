// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <tbb/parallel_for.h>
#include <type_traits>

#include "voxel/space/error.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Shared by the filters of scenes: checks, sample indices, rounding, and parallel work on slices.
namespace octotomy::voxel {

/// The offset of a sample in a scene's samples. Precondition: the index lies inside the scene.
inline std::size_t sample_index(const glm::ivec3& dims, const glm::ivec3& p) {
  assert(p.x >= 0 && p.x < dims.x && p.y >= 0 && p.y < dims.y && p.z >= 0 && p.z < dims.z);
  return (static_cast<std::size_t>(p.z) * static_cast<std::size_t>(dims.y) + static_cast<std::size_t>(p.y)) *
             static_cast<std::size_t>(dims.x) +
         static_cast<std::size_t>(p.x);
}

inline std::size_t slice_size(const Lattice& lattice) {
  return static_cast<std::size_t>(lattice.dims.x) * static_cast<std::size_t>(lattice.dims.y);
}

/// Throws std::invalid_argument as check(Scene) does, and if the samples are labels; the message then ends
/// with `refusal`.
inline void check_values(const Scene& scene, const std::string& refusal) {
  check(scene);
  if (scene.meaning == Meaning::Label) throw InvalidInput("labels have no order: " + refusal);
}

/// A scene on another lattice with all other facts of `scene`, but without samples and holes.
inline Scene empty_scene_like(const Scene& scene, const Lattice& lattice) {
  return {lattice,     {}, scene.meaning,  scene.modality, scene.source,
          scene.audit, {}, scene.identity, scene.overlaps, scene.padding};
}

/// Converts a value to a sample. An int16 sample is the nearest integer, halves upwards, clamped to the
/// type's range.
template <typename Sample>
Sample rounded(double value) {
  if constexpr (std::is_same_v<Sample, std::int16_t>)
    return static_cast<Sample>(std::clamp(std::floor(value + 0.5), -32768.0, 32767.0));
  else
    return static_cast<Sample>(value);
}

/// Calls work(k) for every slice k, sixteen slices in parallel at a time. Between groups it reports progress,
/// and throws Stopped if the stop token is set.
template <typename Work>
void for_each_slice(int slices, const Progress& progress, const Work& work) {
  constexpr int at_once = 16;
  for (int from = 0; from < slices; from += at_once) {
    progress.at(static_cast<double>(from) / slices);
    tbb::parallel_for(from, std::min(from + at_once, slices), work);
  }
}

}  // namespace octotomy::voxel
