// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The slice-based representation (thesis 3.2.5): only the acquired slices are kept, and samples between them
/// are interpolated when they are read. Copies share the slices. Precondition of all functions: int16
/// samples.
class SliceStack {
 public:
  /// Throws std::invalid_argument if the scene has other samples than int16, or no slice.
  explicit SliceStack(std::shared_ptr<const Scene> scene);

  const Scene& scene() const { return *scene_; }
  /// The sample of column x, y at a height between slices, linear along z. Outside the scan, no value.
  std::optional<double> sample(int x, int y, double z) const;
  /// Looks along a column from `from_z` towards `to_z`: the height of the first crossing of the threshold
  /// from below, or `from_z` if the sample there is not below it; none if all samples are below. Both heights
  /// lie in the stack.
  std::optional<double> first_at_least(int x, int y, double threshold, double from_z, double to_z) const;
  /// Bytes of the stored slices and, for comparison, of `slice_count` interpolated slices.
  std::uint64_t bytes() const;
  std::uint64_t bytes_interpolated(int slice_count) const;

 private:
  double at(int x, int y, int z) const;

  std::shared_ptr<const Scene> scene_;
  const std::int16_t* samples_ = nullptr;
};

}  // namespace octotomy::voxel
