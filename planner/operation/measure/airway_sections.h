// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/measure/half_width.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// A section of an airway perpendicular to its centre line.
struct AirwaySection {
  double along_mm = 0.0;  ///< distance along the centre line from its beginning
  glm::dvec3 at_mm{0.0}, direction{0.0, 0.0, 1.0};
  double voxel_mm2 = 0.0;
  double perimeter_mm = 0.0;
  std::optional<double> mesh_mm2;  ///< none without a mesh, or if its section has no closed contour there

  double area_mm2() const { return mesh_mm2.value_or(voxel_mm2); }
};

struct AirwaySections {
  std::vector<AirwaySection> sections;  ///< in their order along the line
  double length_mm = 0.0;
  std::size_t narrowest = 0;
};

/// The sections of an airway from one point to another, each the part of the plane's cut that contains the
/// centre line. The line runs through the centres of voxels at equal path length from the beginning, smoothed
/// over the width. Sections nearer to an end than half the width do not count for the narrowest, because the
/// line is unreliable there. Throws std::runtime_error if a point is farther than 5 mm from the passage, no
/// path connects the two, or the path is shorter than its width. Cost: a search through the voxels, n log n;
/// a cut in both kernels per section.
AirwaySections airway_sections(const voxel::Octree& octree, const std::optional<brep::Solid>& solid,
                               const glm::dvec3& from_mm, const glm::dvec3& to_mm, double step_mm);

/// Half-width of a section's area: the errors of the boundary within voxels and within samples along its
/// perimeter P, 2.6 h sqrt(P h / 12) each for independent steps h; and the window's shift along the whole
/// perimeter.
HalfWidth section_half_width(const AirwaySection& section, const Digitised& digitised);

}  // namespace octotomy::planner
