// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "brep/mesh/health.h"
#include "brep/mesh/measure.h"
#include "planner/operation/measure/measured_size.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/json.h"
#include "voxel/measure/measure.h"
#include "voxel/space/scene.h"

// Parts of the program's answers as JSON. Keys end in their unit; a missing number is null.
namespace octotomy::planner {

/// The first members of every answer: {"octotomy": version, "timings_ms": {...}}.
Json answer(const Timings& timings);

Json to_json(const glm::dvec3& value);
Json to_json(const std::optional<glm::dvec3>& value);
/// A matrix as a list of its rows.
Json to_json(const glm::dmat3& matrix);
Json to_json(const glm::dmat4& matrix);
Json to_json(const std::vector<voxel::Finding>& audit);
/// The gaps of a scan that are interpolated between images, each with the lattice's slices inside it.
Json to_json(const std::vector<voxel::Hole>& holes, const voxel::Lattice& lattice);
VoxelSize size_of(const voxel::Measures& measures);
MeshSize size_of(const brep::Measures& measures);
Json to_json(const voxel::Measures& measures);
Json to_json(const brep::Measures& measures);
Json to_json(const brep::Health& health);
Json to_json(const verify::Certificate& certificate);
Json to_json(const HalfWidth& width);
Json to_json(const ScanRecord& scan);
Json to_json(const Object& object);

/// A scan's geometry, range and audit, as printed by `info`.
Json scan_answer(const voxel::Scene& scene, const Timings& timings);

/// The text of a verdict in an audit: "PASS", "WARN" or "FAIL".
using verify::to_string;

inline constexpr const char* voxel_area_estimator = "Crofton formula, 13 directions";
inline constexpr const char* mesh_area_estimator = "triangles of the isosurface of the scan's own samples";

}  // namespace octotomy::planner
