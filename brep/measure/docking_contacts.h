// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/progress.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {

/// A place where an object bears a part.
struct DockingContact {
  glm::dvec3 p_mm{0.0};    ///< on the object's surface, LPS
  glm::dvec3 normal{0.0};  ///< unit, out of the object: the direction in which it pushes the part
  double gap_mm = 0.0;     ///< distance from there to the part
};

struct DockingContactsOptions {
  double within_mm = 0.4;   ///< the largest gap that counts as contact; above 0
  double spacing_mm = 1.0;  ///< about the distance of neighbouring contacts; above 0
  /// Normals are means over the objects' surface within this distance, as far as it faces the same way to 37
  /// degrees; which way a place faces is the mean within half of it. 0: normals of triangles.
  double smooth_mm = 2.0;
  Progress progress = {};
};

/// Where a part's surface lies against objects: the points of the objects that are nearest to points of the
/// part, if they are near enough and the surfaces face each other to within 60 degrees. Corners of triangles
/// come first, so that the extent of flat faces is exact. Throws std::invalid_argument if a solid is empty or
/// an option is out of its range; Stopped. Cost: a tree over the objects' triangles near the part; log n for
/// each point of the part.
std::vector<DockingContact> docking_contacts(const Solid& part, const std::vector<Solid>& objects,
                                             const DockingContactsOptions& options);

/// Points of a part's surface, about `spacing_mm` apart, whose outward normals are within 60 degrees of the
/// opposite of a push, a unit vector: where a finger can push.
std::vector<glm::dvec3> pushed_surface(const Solid& part, const glm::dvec3& push, double spacing_mm);

}  // namespace octotomy::brep
