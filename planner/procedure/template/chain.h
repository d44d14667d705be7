// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"
#include "planner/plan/plan.h"
#include "planner/procedure/template/procedure.h"

// Procedures in succession: each acts on the planned outcome of the one before.
namespace octotomy::planner {

/// The result of the plan's last procedure: the last step that is called "planned" or "rebuilt", alone or
/// after a name and "_", or that is the outcome of one of the program's procedures whose steps the plan has.
/// None if there is no such step.
std::optional<std::string> outcome_of(const Plan& plan);

/// The name that a step has in the procedure's file, options included, if chained() made its name `id`. None:
/// chained() makes no such name for this procedure.
std::optional<std::string> name_before_chaining(const Procedure& procedure, const std::string& id);
/// Whether chained() makes this name for a step of the procedure or of its options.
bool is_chained_step_of(const Procedure& procedure, const std::string& id);

/// A plan's landmarks after the motions that its outcome contains, as chained() places them.
std::vector<brep::Landmark> carried_landmarks(const Plan& plan, const Evaluation& evaluated);

struct Chained {
  nlohmann::ordered_json plan;       ///< JSON, to be parsed in the input plan's folder
  std::vector<std::string> made;     ///< ids of the added steps
  std::vector<std::string> carried;  ///< landmarks of the procedure that lie on a piece that has moved
};

/// A plan followed by a procedure that acts on its outcome. The names of added steps begin with the
/// procedure's name, "genioplasty_chin", so that they stay unique; if the procedure is used a second time
/// they begin with "genioplasty_2". The plan's outcome takes the place of the procedure's bone, its window of
/// the scan.
///
/// The input's landmarks lie where the scan shows them, in LPS; those that the plan has may be left out. A
/// landmark moves with a piece if the nearest voxel of the object from which the piece was cut belongs to the
/// piece and lies within 8 mm. `evaluated` is the plan's evaluation, with the objects that move. The input's
/// scan, voxel size and folder are not read: the plan's are used.
///
/// Throws std::runtime_error as plan_of(), and if the plan has no outcome, if a landmark of the input differs
/// from the plan's, or if the input has a value that only the window uses.
Chained chained(const Plan& plan, const Evaluation& evaluated, const Procedure& procedure,
                const ProcedureInput& input);

}  // namespace octotomy::planner
