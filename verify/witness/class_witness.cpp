// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/class_witness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "verify/witness/sample_sides.h"
#include "voxel/space/error.h"

namespace octotomy::verify {
namespace {

/// Computes the class of single samples of a scan, each time that it is read.
class Classed {
 public:
  Classed(std::shared_ptr<const voxel::Scene> scan, ClassedBy by)
      : scan_(std::move(scan)),
        by_(std::move(by)),
        dims_(scan_->lattice.dims),
        voxel_from_lps_(glm::inverse(scan_->lattice.lps_from_voxel)) {
    if (by_.meant >= by_.centres.size())
      throw voxel::InvalidInput("the number of the described class is larger than that of the last class");
  }

  AllowedSides allowed(const glm::dvec3& p_mm) const {
    return sides_by_samples(glm::dvec3(voxel_from_lps_ * glm::dvec4(p_mm, 1.0)), dims_,
                            [&](const glm::ivec3& sample) { return side(sample); });
  }

 private:
  double value(const glm::ivec3& sample) const {
    const glm::ivec3 held = glm::clamp(sample, glm::ivec3(0), dims_ - 1);
    const std::size_t i = static_cast<std::size_t>(held.x) +
                          static_cast<std::size_t>(dims_.x) *
                              (static_cast<std::size_t>(held.y) +
                               static_cast<std::size_t>(dims_.y) * static_cast<std::size_t>(held.z));
    return std::visit([&](const auto& samples) { return static_cast<double>(samples[i]); }, scan_->samples);
  }
  bool is_padding(double value) const { return scan_->padding && value == *scan_->padding; }

  SampleSide side(const glm::ivec3& sample) const {
    if (glm::any(glm::lessThan(sample, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(sample, dims_)))
      return {false, true};
    const double density = value(sample);
    if (is_padding(density) || std::isnan(density)) return {false, true};
    // The sample's slopes along the three edges of a voxel determine its gradient in millimetres.
    glm::dvec3 rise(0.0);
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 one(0);
      one[axis] = 1;
      const double after = value(sample + one), before = value(sample - one);
      if (is_padding(after) || is_padding(before)) return {};
      rise[axis] = (after - before) / 2.0;
    }
    const glm::dmat3 edges(scan_->lattice.lps_from_voxel);
    const double volume = glm::dot(edges[0], glm::cross(edges[1], edges[2]));
    const glm::dvec3 gradient =
        (rise.x * glm::cross(edges[1], edges[2]) + rise.y * glm::cross(edges[2], edges[0]) +
         rise.z * glm::cross(edges[0], edges[1])) /
        volume;
    return side_of({density, glm::length(gradient)});
  }

  /// A kernel may hold gradients in single precision: features are uncertain by 2^-22 of their size.
  SampleSide side_of(const glm::dvec2& features) const {
    const glm::dvec2 place = features / by_.scale;
    const double unsure = std::ldexp(glm::length(place) + 1.0, -22);
    double meant = 0.0, other = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < by_.centres.size(); ++i) {
      const double away = glm::distance(place, by_.centres[i] / by_.scale);
      if (i == by_.meant)
        meant = away;
      else
        other = std::min(other, away);
    }
    return {meant + 2.0 * unsure < other, other + 2.0 * unsure < meant};
  }

  std::shared_ptr<const voxel::Scene> scan_;
  ClassedBy by_;
  glm::ivec3 dims_;
  glm::dmat4 voxel_from_lps_;
};

}  // namespace

Witness witness_of_class(std::shared_ptr<const voxel::Scene> scan, const ClassedBy& by) {
  const auto classed = std::make_shared<const Classed>(std::move(scan), by);
  return [classed](const glm::dvec3& p_mm, double) {
    const AllowedSides allowed = classed->allowed(p_mm);
    return Reading{allowed, allowed, 0};
  };
}

}  // namespace octotomy::verify
