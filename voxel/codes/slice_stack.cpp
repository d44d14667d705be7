// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/codes/slice_stack.h"

#include <cassert>
#include <cmath>
#include <stdexcept>

namespace octotomy::voxel {

SliceStack::SliceStack(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {
  const auto* samples = std::get_if<Int16Samples>(&scene_->samples);
  if (samples == nullptr || samples->empty())
    throw std::invalid_argument("slice stack: the scan needs slices of 16-bit samples");
  samples_ = samples->data();
}

double SliceStack::at(int x, int y, int z) const {
  const glm::ivec3& dims = scene_->lattice.dims;
  return samples_[static_cast<std::size_t>(x) +
                  static_cast<std::size_t>(dims.x) *
                      (static_cast<std::size_t>(y) +
                       static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(z))];
}

std::optional<double> SliceStack::sample(int x, int y, double z) const {
  const glm::ivec3& dims = scene_->lattice.dims;
  if (x < 0 || y < 0 || x >= dims.x || y >= dims.y || !(z >= 0.0 && z <= dims.z - 1)) return std::nullopt;
  const int below = static_cast<int>(std::floor(z));
  const double share = z - below;
  if (share == 0.0) return at(x, y, below);
  return (1.0 - share) * at(x, y, below) + share * at(x, y, below + 1);
}

std::optional<double> SliceStack::first_at_least(int x, int y, double threshold, double from_z,
                                                 double to_z) const {
  assert(sample(x, y, from_z) && sample(x, y, to_z));
  double z = from_z, value = *sample(x, y, z);
  if (value >= threshold) return z;
  const bool rises = to_z > from_z;
  // Between neighbouring slices the samples are linear, so the samples at both ends determine the first
  // crossing there.
  while (z != to_z) {
    const double slice = rises ? std::floor(z) + 1.0 : std::ceil(z) - 1.0;
    const double next = rises ? std::min(slice, to_z) : std::max(slice, to_z);
    const double next_value = *sample(x, y, next);
    if (next_value >= threshold) return z + (next - z) * (threshold - value) / (next_value - value);
    z = next;
    value = next_value;
  }
  return std::nullopt;
}

std::uint64_t SliceStack::bytes() const {
  return bytes_interpolated(scene_->lattice.dims.z);
}

std::uint64_t SliceStack::bytes_interpolated(int slice_count) const {
  const glm::ivec3& dims = scene_->lattice.dims;
  return sizeof(std::int16_t) * static_cast<std::uint64_t>(dims.x) * static_cast<std::uint64_t>(dims.y) *
         static_cast<std::uint64_t>(slice_count);
}

}  // namespace octotomy::voxel
