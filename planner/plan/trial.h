// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "planner/operation/measure/trials.h"
#include "planner/plan/evaluate.h"

namespace octotomy::planner {

/// {"doubts": [{"what", "of", "value", "unit", "half_width", "coverage", "sources": [{"name",
/// "half_width"}]}], "findings"}: how much random errors may change the numbers of a plan. The numbers are,
/// for each moved piece, its rotations and the displacements of its centroid and landmarks along the head's
/// directions; gap and overlap of each pair that a step measures or maps, and of moved pieces with the
/// objects they are united with; and distances and angles of marks. The interval value ± half_width contains
/// the number in 99 of 100 trials. The half-width of a source is that for errors of this source alone.
///
/// Motions are computed exactly from the marks that define them. Gaps and overlaps are computed to first
/// order: each surface point near the other surface is displaced along the shortest line between the two. The
/// overlap is area times depth, scaled to the voxels' overlap. A pair without meshes is left out, with a
/// finding. The same seed gives the same bits on any number of threads. Cost: about a second for 10,000
/// trials of ten pairs.
nlohmann::ordered_json trials_json(const Plan& plan, const Evaluation& evaluation, const Trials& asked);

}  // namespace octotomy::planner
