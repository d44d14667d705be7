// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/json.h"
#include "voxel/tree/octree.h"

namespace octotomy::planner {

/// {"min_UNIT", "mean_UNIT", "median_UNIT", "max_UNIT"} of values with weights; all null where there are none.
Json weighted_summary(std::vector<std::pair<double, double>> value_and_weight, const std::string& unit);

/// Local thickness by the mesh kernel: {"definition", "ray", "ball" (over the surface), "volume" (over the
/// volume, with its interval), "wall" (the surface away from edges)}, and at vertices. Throws and costs as
/// brep::local_thickness().
Json thickness_json(const brep::Solid& solid, const voxel::Progress& progress,
                    std::vector<double>& at_vertices);

/// The thickness by the voxel kernel, without rays. Throws and costs as voxel::local_thickness().
Json thickness_json(const voxel::Octree& octree, const voxel::Progress& progress);

}  // namespace octotomy::planner
