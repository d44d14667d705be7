// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "planner/operation/measure/trials.h"
#include "planner/plan/evaluate.h"

namespace octotomy::planner {

/// {"doubts": [{"what", "of", "value", "unit", "half_width", "coverage", "sources": [{"name",
/// "half_width"}]}], "findings"}: each moved piece's rotations, and the displacements of its centroid and
/// landmarks along the head's directions; the gap and overlap of each pair that a step measures or maps, and
/// of moved pieces with the objects they are united with; each distance and angle of marks. The interval of
/// the half-width contains the value in 99 of 100 trials; the half-width of a source is that with errors of
/// this source alone.
///
/// Motions are computed exactly from the marks that define them. Gaps and overlaps are computed to first
/// order: each surface point near the other surface is displaced along the shortest line between the two; the
/// overlap is the area times its depth, scaled to the voxels' overlap. A pair without meshes is left out,
/// with a finding. The same seed produces the same bits on any number of threads. Cost: about a second for
/// 10,000 trials of ten pairs.
nlohmann::ordered_json trials_json(const Plan& plan, const Evaluation& evaluation, const Trials& asked);

}  // namespace octotomy::planner
