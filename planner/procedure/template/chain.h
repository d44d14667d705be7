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

/// The object that the plan's last procedure ends with: the last step that is called "planned" or "rebuilt",
/// alone or after a name and "_", or that is the outcome of one of the program's procedures whose steps the plan
/// has. None: the plan has no such step.
std::optional<std::string> outcome_of(const Plan& plan);

/// The name in the procedure's file of a step that chained() named for the procedure, with or without its options.
/// None: chained() names no step of the procedure so.
std::optional<std::string> name_before_chaining(const Procedure& procedure, const std::string& id);
/// Whether chained() named this step for the procedure, with or without its options.
bool is_chained_step_of(const Procedure& procedure, const std::string& id);

/// A plan's landmarks after the motions from which its outcome is made, as chained() places them.
std::vector<brep::Landmark> carried_landmarks(const Plan& plan, const Evaluation& evaluated);

struct Chained {
  nlohmann::ordered_json plan;       ///< JSON, to be parsed in the folder of the plan before
  std::vector<std::string> made;     ///< ids of the added steps
  std::vector<std::string> carried;  ///< landmarks of the procedure that lie on a piece that has moved
};

/// A plan followed by a procedure that acts on its outcome. The added steps are called after the procedure,
/// "genioplasty_chin", so that each procedure has names of its own; a second one of the same name is
/// "genioplasty_2". The procedure's bone, its window of the scan, is the outcome before.
///
/// Landmarks of the input are where the scan shows them, LPS; those that the plan has need not be given again.
/// A landmark moves with the pieces on which it lies: of the voxels within 8 mm of it, of the object that a
/// piece was cut from, the nearest decides. `evaluated` is the plan's evaluation, with the objects that move.
/// The input's scan, voxels and folder are not read: they are the plan's.
///
/// Throws std::runtime_error as plan_of(); where the plan has no outcome; where a landmark lies elsewhere in
/// the plan; where a value is typed that only the window uses.
Chained chained(const Plan& plan, const Evaluation& evaluated, const Procedure& procedure,
                const ProcedureInput& input);

}  // namespace octotomy::planner
