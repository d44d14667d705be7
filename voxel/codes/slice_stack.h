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
  /// Throws std::invalid_argument if the scene's samples are not int16, or it has no slice.
  explicit SliceStack(std::shared_ptr<const Scene> scene);

  const Scene& scene() const { return *scene_; }
  /// The sample of column x, y at the height z in slices, interpolated linearly between slices. None outside
  /// the scan.
  std::optional<double> sample(int x, int y, double z) const;
  /// Searches a column from `from_z` to `to_z` for the first height at which the sample is at least the
  /// threshold. None if all samples are below the threshold. Precondition: both heights lie in the stack.
  std::optional<double> first_at_least(int x, int y, double threshold, double from_z, double to_z) const;
  /// Bytes of the stored slices. For comparison, bytes_interpolated() returns the bytes of `slice_count`
  /// interpolated slices.
  std::uint64_t bytes() const;
  std::uint64_t bytes_interpolated(int slice_count) const;

 private:
  double at(int x, int y, int z) const;

  std::shared_ptr<const Scene> scene_;
  const std::int16_t* samples_ = nullptr;
};

}  // namespace octotomy::voxel
