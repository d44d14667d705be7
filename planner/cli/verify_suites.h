// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/verify_verbs.h"

// The suites that `verify` has besides plans, a source file each.
namespace octotomy::planner::cli {

/// --faults
extern const Suite fault_suite;
/// --random N --seed S --failures FOLDER
extern const Suite random_suite;
/// --thesis
extern const Suite thesis_suite;

}  // namespace octotomy::planner::cli
