// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// The distances in memory from a row to the next and from a slice to the next, in samples.
struct RowSteps {
  std::size_t row = 0, slice = 0;
};

/// A scan's samples at the voxel centres of a universe, read along the universe's rows, 16 voxels at a time.
/// If the lattices coincide, these are the scan's samples, otherwise they are interpolated trilinearly. They
/// are rounded to the nearest multiple of the step, halves upward. Refers to the scene, which must outlive
/// the object.
class ScanRows {
 public:
  static constexpr int length = 16;
  /// Voxels whose centre lies outside the scene's bounds, or whose sample would depend on the scene's
  /// padding, have the sample `background` and do not lie in the scan.
  ScanRows(const Universe& universe, const Scene& scene, std::int16_t background, double step);

  /// The least number n such that the universe's slices first..last depend only on the scan's first n slices.
  int slices_read(int first, int last) const;

  /// A pointer to the first sample of the block of 16 x 16 x 16 voxels at `origin`, if every voxel of the
  /// block is a sample of the scan and the scan has no padding; otherwise null. The distances to the block's
  /// other samples are those of steps().
  const std::int16_t* own_samples(const glm::ivec3& origin) const;
  RowSteps steps() const;

  /// Reads a row of 16 voxels that begins at `first`. Bit i of the result is set if the row's voxel i lies in
  /// the scan. Precondition: `first` lies in the universe. Throws std::invalid_argument if a float sample
  /// leaves the int16 range.
  std::uint16_t read(const glm::ivec3& first, std::int16_t* row) const;

 private:
  /// A position along one axis, between two samples or outside the scan.
  struct AxisPosition {
    int low = 0;
    int high = 0;
    double share = 0.0;  ///< weight of the higher sample
    bool inside = false;
  };
  bool is_diagonal() const;
  glm::dvec3 position(const glm::dvec3& voxel) const;
  AxisPosition place(int axis, double p) const;
  std::array<AxisPosition, 3> places(const glm::ivec3& voxel) const;
  std::size_t index(int y, int z) const;
  /// Whether an interpolated sample would depend on padding.
  template <typename Sample>
  bool is_mixed(const Sample* samples, const std::array<AxisPosition, 3>& at) const;
  template <typename Sample>
  std::uint16_t copy(const Sample* samples, const glm::ivec3& first, std::int16_t* row) const;
  template <typename Sample>
  std::uint16_t interpolate(const Sample* samples, const glm::ivec3& first, std::int16_t* row) const;
  std::uint16_t interpolate_along(const std::int16_t* samples, const glm::ivec3& first,
                                  std::int16_t* row) const;
  std::int16_t rounded(double value) const;

  const Scene& scene_;
  glm::ivec3 dims_;
  std::int16_t background_;
  double step_;
  glm::dmat4 scan_from_universe_;
  /// Offset from the universe's voxels to the scan's samples, if the two lattices coincide.
  std::optional<glm::ivec3> offset_;
  std::array<std::vector<AxisPosition>, 3>
      along_;  ///< for each axis and voxel its position, if the lattices' axes are parallel
  struct {
    std::vector<std::int32_t> low, high;
    std::vector<double> share;
  } in_row_;  ///< the members of along_[0], each as an array
};

}  // namespace octotomy::voxel
