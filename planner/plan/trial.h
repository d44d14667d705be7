// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "planner/operation/measure/trials.h"
#include "planner/plan/evaluate.h"

namespace octotomy::planner {

/// {"doubts": [{"what", "of", "value", "unit", "half_width", "coverage", "sources": [{"name",
/// "half_width"}]}], "findings"}: what each moved piece's turns, its centroid and its landmarks are displaced
/// by along the head's directions; the gap and the overlap of each pair that a step measures or maps and of
/// the moved pieces with what they are united with; each distance and angle of marks. The half-width holds
/// the value in 99 of 100 trials; a source's is what it leaves alone.
///
/// Motions are followed exactly from the marks that they are made of. Gaps and overlaps are followed to first
/// order: each surface point near the other surface is displaced along the shortest way between the two; the
/// overlap is the area times its depth, scaled to that of the voxels. A pair without meshes is left out, as a
/// finding tells. The same seed gives the same bits on any number of threads. Cost: about a second for 10 000
/// trials of ten pairs.
nlohmann::ordered_json trials_json(const Plan& plan, const Evaluation& evaluation, const Trials& asked);

}  // namespace octotomy::planner
