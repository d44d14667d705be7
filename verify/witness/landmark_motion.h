// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "brep/mesh/triangles.h"
#include "verify/witness/reading.h"
#include "verify/witness/reshaped_witness.h"

namespace octotomy::verify {

/// Displacements of landmarks as a field over space: at a landmark its own, zero beyond reach_mm from all of them, and
/// in between a sum of (1 - r)^4 (4 r + 1) about each, r = distance / reach_mm. No kernel shares this code. LPS
/// millimetres.
class LandmarkMotion {
 public:
  /// Throws std::invalid_argument without landmarks, unless each has one displacement, or if two coincide.
  LandmarkMotion(std::vector<glm::dvec3> landmarks_mm, std::vector<glm::dvec3> displacement_mm,
                 double reach_mm);

  glm::dvec3 displacement_mm(const glm::dvec3& p_mm) const;
  /// The origin of a point, as NodeMotion finds it.
  std::optional<glm::dvec3> origin_mm(const glm::dvec3& p_mm, const glm::dvec3& guess_mm) const;
  std::optional<glm::dvec3> origin_mm(const glm::dvec3& p_mm) const { return origin_mm(p_mm, p_mm); }

 private:
  std::vector<glm::dvec3> landmarks_mm_, weights_mm_;
  double reach_mm_;
};

/// A surface whose points move with landmarks. The reach is rounding.
ReshapedSurface surface_warped(const brep::Triangles& still, const LandmarkMotion& motion);

/// An object that moved with landmarks, as witness_of_warped() of a NodeMotion. Empty where the still object has no
/// witness.
Witness witness_of_warped(Witness still, const brep::Triangles& still_surface,
                          std::shared_ptr<const LandmarkMotion> motion);

}  // namespace octotomy::verify
