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

/// Weighted statistics of values: {"min_UNIT", "mean_UNIT", "median_UNIT", "max_UNIT"}; all null if there are
/// no values.
Json weighted_summary(std::vector<std::pair<double, double>> value_and_weight, const std::string& unit);

/// Local thickness in mm by the mesh kernel: {"definition", "ray", "ball" (over the surface), "volume" (over
/// the volume, with its interval), "wall" (the surface away from edges), "samples" (their number),
/// "sample_reach_mm"}, and the values at vertices. Throws and costs as brep::local_thickness().
Json thickness_json(const brep::Solid& solid, const voxel::Progress& progress,
                    std::vector<double>& at_vertices);

/// Local thickness in mm by the voxel kernel, without "ray" and "sample_reach_mm". All voxels of the surface
/// count equally. Throws and costs as voxel::local_thickness().
Json thickness_json(const voxel::Octree& octree, const voxel::Progress& progress);

}  // namespace octotomy::planner
