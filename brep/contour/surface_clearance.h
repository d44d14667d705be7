// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "brep/mesh/morton_tree.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Counts the triangles of other surfaces that a span crosses in space. A span may cross their contours in
/// projection and still pass below or above them, as beside a contour that a roof closes. In mm.
class SurfaceClearance {
 public:
  /// Precondition: all points are finite. Cost: linear.
  explicit SurfaceClearance(Triangles surface);

  /// The number of triangles that a segment crosses between its ends, at most `most`, up to rounding. Cost: log n
  /// and the triangles near the segment.
  int crossed(const glm::dvec3& from_mm, const glm::dvec3& to_mm, int most) const;

 private:
  Triangles surface_;
  MortonTree tree_;
};

}  // namespace octotomy::brep
