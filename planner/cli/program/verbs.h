// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verb/verb.h"

// Each function adds the verbs of one source file to the program.
namespace octotomy::planner::cli {

/// Adds a verb for every operation of the table that works on files. Such a verb is a plan of one step. Its
/// options, checks and help come from the operation's fields.
void add_operation_verbs(Program& program);
void add_info(Program& program);
void add_convert(Program& program);
void add_phantom(Program& program);
void add_prepare(Program& program);
void add_plan_verbs(Program& program);
void add_plan_document(Program& program);  ///< plan diff, plan merge, plan history
void add_procedure(Program& program);
void add_look(Program& program);
void add_mark(Program& program);
void add_cohort(Program& program);
void add_cephalometry(Program& program);
void add_outcome(Program& program);
void add_pack(Program& program);
void add_scene(Program& program);
void add_archive_verbs(Program& program);  ///< send, receive
void add_serve(Program& program);

}  // namespace octotomy::planner::cli
