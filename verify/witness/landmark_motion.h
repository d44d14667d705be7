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

/// The displacements of landmarks as a field over space. At a landmark the field is the landmark's
/// displacement, and it is zero beyond reach_mm from all landmarks. In between it is a sum of (1 - r)^4 (4 r
/// + 1) about each landmark, r = distance / reach_mm. No kernel shares this code. LPS millimetres.
class LandmarkMotion {
 public:
  /// Throws std::invalid_argument without landmarks, unless each landmark has one displacement, or if two
  /// landmarks coincide.
  LandmarkMotion(std::vector<glm::dvec3> landmarks_mm, std::vector<glm::dvec3> displacement_mm,
                 double reach_mm);

  glm::dvec3 displacement_mm(const glm::dvec3& p_mm) const;
  /// The point that the field moves to `p_mm`, computed as NodeMotion::origin_mm() does.
  std::optional<glm::dvec3> origin_mm(const glm::dvec3& p_mm, const glm::dvec3& guess_mm) const;
  std::optional<glm::dvec3> origin_mm(const glm::dvec3& p_mm) const { return origin_mm(p_mm, p_mm); }

 private:
  std::vector<glm::dvec3> landmarks_mm_, weights_mm_;
  double reach_mm_;
};

/// The expected surface of an object whose points move with landmarks. The reach is the rounding of
/// displacements.
ReshapedSurface surface_warped(const brep::Triangles& still, const LandmarkMotion& motion);

/// A witness of an object that moved with landmarks; as witness_of_warped() of a NodeMotion. Empty if the
/// still object has no witness.
Witness witness_of_warped(Witness still, const brep::Triangles& still_surface,
                          std::shared_ptr<const LandmarkMotion> motion);

}  // namespace octotomy::verify
