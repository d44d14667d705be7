// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/verb/verb.h"

// The verbs that do not derive from the table of operations: each of these adds those of its file.
namespace octotomy::planner::cli {

void add_info(Program& program);
void add_convert(Program& program);
void add_phantom(Program& program);
void add_prepare(Program& program);
void add_segment(Program& program);
void add_plan_verbs(Program& program);
void add_plan_document(Program& program);  ///< plan diff, plan merge, plan history
void add_procedure(Program& program);
void add_look(Program& program);
void add_mark(Program& program);
void add_cohort(Program& program);
void add_cephalometry(Program& program);
void add_outcome(Program& program);
void add_serve(Program& program);

}  // namespace octotomy::planner::cli
