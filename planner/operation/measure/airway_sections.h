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
  double along_mm = 0.0;  ///< from the beginning, along the centre line
  glm::dvec3 at_mm{0.0}, direction{0.0, 0.0, 1.0};
  double voxel_mm2 = 0.0;
  double perimeter_mm = 0.0;
  std::optional<double> mesh_mm2;  ///< none without a mesh, or without a closed contour there

  double area_mm2() const { return mesh_mm2.value_or(voxel_mm2); }
};

struct AirwaySections {
  std::vector<AirwaySection> sections;  ///< in their order along the centre line
  double length_mm = 0.0;
  std::size_t narrowest = 0;
};

/// The sections of an airway from one point to another. A section is the part of a plane's cut that contains
/// the centre line. The centre line connects the centres of voxels at equal path length from the beginning,
/// and is smoothed over the airway's width. Sections within half a width of an end cannot be the narrowest,
/// because the centre line is unreliable there. Throws std::runtime_error if a point is farther than 5 mm
/// from the passage, no path connects the points, or the path is shorter than the airway's width. Cost: a
/// search through the voxels, n log n; a cut in both kernels per section.
AirwaySections airway_sections(const voxel::Octree& octree, const std::optional<brep::Solid>& solid,
                               const glm::dvec3& from_mm, const glm::dvec3& to_mm, double step_mm);

/// Half-width of a section's area in mm2. One term each for voxels and for the scan's samples is the error of
/// the boundary along the section's perimeter P, 2.6 h sqrt(P h / 12) for independent steps of length h. The
/// last term is the window's shift along the whole perimeter.
HalfWidth section_half_width(const AirwaySection& section, const Digitised& digitised);

}  // namespace octotomy::planner
