// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "planner/measure/half_width.h"
#include "planner/measure/result_json.h"
#include "verify/size_interval.h"
#include "voxel/tree/grey_octree.h"

// The recommended volume and area of an object, each one number with one interval.
namespace octotomy::planner {

/// {"value", "unit", "half_width", "coverage", "sources"}.
Json to_json(const verify::Interval& interval, const std::string& unit);

/// Where an object's surface was sampled.
struct SurfaceSamples {
  glm::dmat3 scan_edges{1.0};        ///< columns: steps of the scan's lattice in LPS millimetres, unmoved
  glm::dmat4 moved_from_still{1.0};  ///< LPS to LPS, of all motions since
  std::optional<voxel::GreyOctree> grey;  ///< of that scan; none: no blur is looked for
  bool voxels_are_samples = false;        ///< of the grey octree
  std::optional<double> window_shift_mm;
  std::optional<glm::dvec3> along_lps_mm = {};  ///< as verify::SampledFrom's
};
/// By the mesh kernel, whose surface samples place to a part of their spacing.
verify::SizeIntervals intervals_of_surface(const brep::Solid& solid, const SurfaceSamples& samples);

/// By counting, where there are voxels alone: volume_half_width(); the area by Crofton's formula with flat
/// parts along the lattice as they are, its half-width what the formula may lose of oblique planes. Both are
/// widened to what is seen.
verify::SizeIntervals intervals_of_count(const voxel::Measures& measures, const Digitised& digitised,
                                         const voxel::Lattice& lattice,
                                         const std::optional<SeenSize>& seen = {});

}  // namespace octotomy::planner
