// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/suite/suite.h"

// The suites of `verify` besides plans, one source file each.
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

/// Sets `held` to false if a PASS has no evidence, unless the command line accepts that.
void need_evidence(SuiteAnswer& answer, const VerifyText& text);

/// Verifies an operation on two meshes or two label maps of any program: text.subject is A, OP, B. Meshes are
/// compared by the bounded tier, label maps by the exact one. Throws as the readers do, and
/// CLI::ValidationError if an argument is invalid.
SuiteAnswer verify_operands(Program& program, const VerifyText& text);
/// Whether a path is a folder or a file of questions: A OP B and an answer to check.
bool holds_questions(const std::filesystem::path& path);
/// Verifies all questions of a path in one run, with a table. The path is a .json file with operands (two
/// paths), operation and result, or a list of these; or a folder with such files and with folders that
/// contain files a, b and union, intersection or difference. Throws as verify_operands() does.
SuiteAnswer verify_questions(Program& program, const VerifyText& text);
/// --voxel MM --answer FILE
void add_operand_options(CLI::App& verb, VerifyText& text);

}  // namespace octotomy::planner::cli
