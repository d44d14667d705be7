// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <variant>

#include "voxel/space/scene.h"

namespace octotomy::convert {

/// The trilinear interpolant of a scan, constant between the outermost samples and the voxels' ends.
/// Precondition: the scan outlives this object.
class ScanSampler {
 public:
  explicit ScanSampler(const voxel::Scene& scan)
      : scan_(scan), voxel_from_lps_(glm::inverse(scan.lattice.lps_from_voxel)) {}

  /// Converts an LPS point to the scan's voxel indices.
  glm::dvec3 voxel(const glm::dvec3& p_mm) const { return voxel_from_lps_ * glm::dvec4(p_mm, 1.0); }
  glm::dvec3 lps_mm(const glm::dvec3& v) const { return scan_.lattice.lps_mm(v); }
  /// Whether a position is in one of the scan's voxels and its value depends on measured samples only.
  bool holds(const glm::dvec3& v) const {
    return glm::all(glm::greaterThanEqual(v, glm::dvec3(-0.5))) &&
           glm::all(glm::lessThanEqual(v, glm::dvec3(scan_.lattice.dims) - 0.5)) &&
           !(scan_.padding && at(v) == *scan_.padding);
  }
  /// The interpolated value. Positions beyond the outermost samples are moved to the nearest sample. Returns
  /// the padding if one of the samples needed is padding.
  double at(const glm::dvec3& v) const {
    const glm::dvec3 most(scan_.lattice.dims - 1);
    const glm::dvec3 inside = glm::clamp(v, glm::dvec3(0.0), most);
    const glm::ivec3 low = glm::min(glm::ivec3(inside), glm::max(scan_.lattice.dims - 2, glm::ivec3(0)));
    const glm::dvec3 t = inside - glm::dvec3(low);
    double sum = 0.0;
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 step(k & 1, (k >> 1) & 1, k >> 2);
      const double weight =
          (step.x != 0 ? t.x : 1.0 - t.x) * (step.y != 0 ? t.y : 1.0 - t.y) * (step.z != 0 ? t.z : 1.0 - t.z);
      if (!(weight > 0.0)) continue;
      const double value = sample(low + step);
      if (scan_.padding && value == *scan_.padding) return value;
      sum += weight * value;
    }
    return sum;
  }

 private:
  double sample(const glm::ivec3& v) const {
    const auto nx = static_cast<std::size_t>(scan_.lattice.dims.x);
    const auto ny = static_cast<std::size_t>(scan_.lattice.dims.y);
    const std::size_t index = static_cast<std::size_t>(v.x) +
                              nx * (static_cast<std::size_t>(v.y) + ny * static_cast<std::size_t>(v.z));
    return std::visit([&](const auto& samples) { return static_cast<double>(samples[index]); },
                      scan_.samples);
  }

  const voxel::Scene& scan_;
  glm::dmat4 voxel_from_lps_;
};

}  // namespace octotomy::convert
