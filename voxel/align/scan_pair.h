// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/align/register_scans.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// A scan at a lower resolution: the mean sample of each block. Along each axis a block is about as wide as
/// the resolution.
struct CoarseScan {
  glm::ivec3 dims{0};
  std::vector<float> values;  ///< x fastest; NaN: a block without measured samples
  glm::dmat4 voxel_from_lps{1.0};
  glm::dmat4 lps_from_voxel{1.0};
  double measured_mm3 = 0.0;
  /// The values' range after the lowest and the highest 1/200 of them are left out.
  float low = 0.0f, high = 1.0f;

  std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(dims.x) *
               (static_cast<std::size_t>(y) + static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(z));
  }
  /// The trilinear value at a position in blocks, clamped to low..high. NaN outside the scan and next to
  /// blocks without measured samples.
  float at(const glm::dvec3& p_voxel) const;
};
CoarseScan coarse_scan(const Scene& scene, double resolution_mm);

/// The mean position of a scan's blocks, in LPS millimetres, weighted by how far each block's value, clamped
/// to low..high, exceeds `low`.
glm::dvec3 centre_of_mass_mm(const CoarseScan& scan);

struct Likeness {
  double value = 0.0;    ///< -1..1 for correlation, 0..1 for mutual information
  double overlap = 0.0;  ///< share of the smaller scan that the other one covers, 0..1
};

/// Two scans at one resolution, compared at points of the fixed scan. Pseudorandom offsets, computed from the
/// points' numbers, move the points off the blocks' centres, because points on a grid favour motions by whole
/// blocks (Pluim, Maintz, Viergever, Interpolation artefacts in mutual information-based image registration,
/// 2000).
class ScanPair {
 public:
  ScanPair(const Scene& moving, const Scene& fixed, double resolution_mm, std::size_t most_points,
           ScanLikeness by);

  /// Runs in parallel; the result has the same bits on any thread count.
  Likeness likeness(const glm::dmat4& moving_from_fixed) const;
  const CoarseScan& moving() const { return moving_; }
  const CoarseScan& fixed() const { return fixed_; }
  std::size_t point_count() const { return points_.size(); }

 private:
  struct Point {
    glm::vec3 p_voxel{0.0f};  ///< in the fixed scan
    float value = 0.0f;
    int bin = 0;
  };

  CoarseScan moving_, fixed_;
  std::vector<Point> points_;
  double point_mm3_ = 1.0;
  ScanLikeness by_;
};

}  // namespace octotomy::voxel
