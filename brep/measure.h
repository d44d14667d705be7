// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "brep/mesh.h"

namespace octotomy::brep {

/// Integrals over a closed mesh and its inside, by the divergence theorem, summed about the mesh's own centre
/// in a fixed order so that neither place nor threads change the answer.
struct Measures {
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  std::optional<glm::dvec3> centroid_mm;  ///< of the inside; none where there is no volume
  glm::dvec3 low_mm{0.0}, high_mm{0.0};   ///< bounding box
  /// Half the sum over edges of length times unsigned angle between the faces' normals: the total absolute
  /// mean curvature, which bounds how much a chordal surface loses.
  double absolute_mean_curvature_mm = 0.0;
};
Measures measure(const Mesh& mesh);

}  // namespace octotomy::brep
