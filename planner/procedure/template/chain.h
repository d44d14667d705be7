// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"
#include "planner/plan/plan.h"
#include "planner/procedure/template/procedure.h"

// Several procedures in one plan: each acts on the planned result of the procedure before it.
namespace octotomy::planner {

/// The step with the result of the plan's last procedure. It is the last step whose name is or ends in "_"
/// and "planned" or "rebuilt", or that the file of one of the program's procedures names as its outcome, if
/// the plan has all of that procedure's steps. None if there is no such step.
std::optional<std::string> outcome_of(const Plan& plan);

/// The name of a step in the procedure's file or its options, for a step that chained() has renamed to `id`.
/// None if chained() gives no step of this procedure that name.
std::optional<std::string> name_before_chaining(const Procedure& procedure, const std::string& id);
/// Whether chained() can have given this name to a step of the procedure or of its options.
bool is_chained_step_of(const Procedure& procedure, const std::string& id);

/// The plan's landmarks after the motions that its outcome contains, as chained() places them. In LPS.
std::vector<brep::Landmark> carried_landmarks(const Plan& plan, const Evaluation& evaluated);

struct Chained {
  nlohmann::ordered_json plan;       ///< JSON; relative paths are relative to the input plan's folder
  std::vector<std::string> made;     ///< ids of the added steps
  std::vector<std::string> carried;  ///< landmarks of the procedure that lie on a moved piece
};

/// A plan followed by a procedure that acts on its outcome. The outcome takes the place of the procedure's
/// bone, which is a window of the scan. The names of added steps begin with the procedure's name, as in
/// "genioplasty_chin", so that they are unique. If the plan already has such names, they begin with
/// "genioplasty_2".
///
/// The landmarks of the input are in LPS, where the scan shows them. Landmarks that the plan has may be left
/// out. A landmark moves with a piece if, within 8 mm, the nearest voxel of the object from which the piece
/// was cut belongs to the piece. `evaluated` is an evaluation of the plan that contains the moved objects.
/// The input's scan, voxel size and folder are not used; the plan's are.
///
/// Throws std::runtime_error as plan_of() does, and if the plan has no outcome, if a landmark of the input
/// differs from the plan's, or if the input has a value that only the window uses.
Chained chained(const Plan& plan, const Evaluation& evaluated, const Procedure& procedure,
                const ProcedureInput& input);

}  // namespace octotomy::planner
