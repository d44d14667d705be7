// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/suite/suite.h"

// The suites that `verify` has besides plans, a source file each.
namespace octotomy::planner::cli {

/// --faults
extern const Suite fault_suite;
/// --phantoms --poses N
extern const Suite phantoms_suite;
/// --random N --tier NAME --seed S --failures FOLDER
extern const Suite random_suite;
/// --self
extern const Suite self_suite;
/// --thesis
extern const Suite thesis_suite;

/// A PASS without evidence is no success: then the answer does not hold, unless that was accepted.
void need_evidence(SuiteAnswer& answer, const VerifyText& text);

/// Two meshes or two label maps and an operation between them, whatever program made them: text.subject is A,
/// OP, B. Meshes by the bounded tier, label maps by the exact one. Throws as the readers do, and
/// CLI::ValidationError where an argument cannot be understood.
SuiteAnswer verify_operands(Program& program, const VerifyText& text);
/// Whether a path is a folder or a file of questions: A OP B and somebody's answer.
bool holds_questions(const std::filesystem::path& path);
/// All of them in one run, with a table: a .json file with operands (two paths), operation and result, or a
/// list of such; or a folder of such files, and of folders with files a, b and union, intersection or
/// difference. Throws as verify_operands().
SuiteAnswer verify_questions(Program& program, const VerifyText& text);
/// --voxel MM --answer FILE
void add_operand_options(CLI::App& verb, VerifyText& text);

}  // namespace octotomy::planner::cli
