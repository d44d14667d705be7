// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/health.h"
#include "brep/mesh/solid.h"
#include "planner/operation/table/json.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

// Checks whether a printer can make a part. Each check has one line with a verdict, numbers and a position.
namespace octotomy::planner {

/// The limits of a printer and its material.
struct PrintLimits {
  glm::dvec3 up{0.0, 0.0, 1.0};  ///< unit, LPS: from the bed to the layers above
  double overhang_deg = 45.0;
  double least_wall_mm = 0.6, least_gap_mm = 0.5;
  glm::dvec3 bed_mm{145.0, 145.0, 185.0};  ///< width, depth and height of the space for a part
};

/// The result of one check.
struct PrintCheck {
  std::string check;                   ///< "wall"
  std::optional<std::string> verdict;  ///< PASS, WARN or FAIL; none if it was not measured
  std::string says;                    ///< one sentence
  std::optional<glm::dvec3> at_mm;     ///< position of the worst fault, LPS
  Json numbers = Json::object();
};

/// Checks whether the surface is closed, free of self-intersection and oriented outward, from the results of
/// health(), with the position of the first fault.
std::vector<PrintCheck> health_checks(const brep::Triangles& triangles, const brep::Health& health);
/// Checks overhangs and the size of the printer's bed, for any surface with triangles. Precondition: the
/// surface can be linked.
std::vector<PrintCheck> build_checks(const brep::Linked& surface, const PrintLimits& limits);
/// Checks pieces, cavities, the least wall and the least gap of a solid. If voxels are passed, too, a PASS
/// becomes a WARN if they have more pieces, or a wall or gap that is smaller by more than voxels can resolve.
/// The cavities of voxels are only counted. Precondition: the solid is not empty.
std::vector<PrintCheck> solid_checks(const brep::Solid& solid, const voxel::Octree* voxels,
                                     const PrintLimits& limits, const voxel::Progress& progress);
/// The four checks of solid_checks(), marked as not measured, with the reason `why`.
std::vector<PrintCheck> missing_solid_checks(const std::string& why);

/// The worst verdict among the checks: FAIL, else WARN, else PASS.
std::string worst_verdict(const std::vector<PrintCheck>& checks);
Json to_json(const std::vector<PrintCheck>& checks);

}  // namespace octotomy::planner
