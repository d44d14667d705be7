// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/measure/half_width.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// A section of a passage square to its centre line.
struct PassageSection {
  double along_mm = 0.0;  ///< on the centre line, from its beginning
  glm::dvec3 at_mm{0.0}, direction{0.0, 0.0, 1.0};
  double voxel_mm2 = 0.0;
  double perimeter_mm = 0.0;
  std::optional<double> mesh_mm2;  ///< none without a mesh, or where its section has no closed contour there

  double area_mm2() const { return mesh_mm2.value_or(voxel_mm2); }
};

struct Passage {
  std::vector<PassageSection> sections;  ///< in their order
  double length_mm = 0.0;
  std::size_t narrowest = 0;
};

/// The sections of a passage from one point to another, each the part of the plane's cut that holds the
/// centre line. The line runs through the middles of what is equally far from the beginning within the
/// passage, smoothed over its width. Sections nearer to an end than half the width there are left out of the
/// narrowest, as the line is not settled there. Throws std::runtime_error where a point lies farther from the
/// passage than 5 mm, no way leads from one to the other, or the way is shorter than its width. Cost: a walk
/// through the voxels, n log n; a cut of both kernels a section.
Passage passage(const voxel::Octree& octree, const std::optional<brep::Solid>& solid,
                const glm::dvec3& from_mm, const glm::dvec3& to_mm, double step_mm);

/// Half-width of a section's area: the boundary's places within voxels, and within samples, along its
/// perimeter, 2.6 h sqrt(P h / 12) each, independent a step h of it; and the window's shift all along it.
HalfWidth section_half_width(const PassageSection& section, const Digitised& digitised);

}  // namespace octotomy::planner
