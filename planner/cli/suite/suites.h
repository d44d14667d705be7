// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/cli/suite/suite.h"

// The suites of `verify`, one source file for each, and its checks of questions.
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

/// Sets `held` to false if a PASS has no evidence, unless --accept-unresolved is given.
void need_evidence(SuiteAnswer& answer, const VerifyText& text);

/// Answers and certifies an operation on files of any program: text.subject is A, OP, B. Meshes are compared
/// within a bound, label maps and octrees exactly. Throws as the readers do, and CLI::ValidationError if an
/// argument is invalid.
SuiteAnswer verify_operands(Program& program, const VerifyText& text);
/// Whether a path is a file or a folder of questions for verify_questions().
bool holds_questions(const std::filesystem::path& path);
/// Certifies all questions of a path in one run and prints a table. The path is a .json file of one or
/// several questions, each with "operands" (two paths), "operation" and optionally "result"; or a folder with
/// such files or with subfolders, each with files a and b and the answers union, intersection or difference.
/// Throws as verify_operands() does.
SuiteAnswer verify_questions(Program& program, const VerifyText& text);
/// --voxel MM --answer FILE
void add_operand_options(CLI::App& verb, VerifyText& text);

}  // namespace octotomy::planner::cli
