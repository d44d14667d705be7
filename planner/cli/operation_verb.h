// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>

#include "planner/table/operation.h"
#include "planner/verb/verb.h"

namespace octotomy::planner::cli {

/// The words on the command line, by field.
using FieldWords = std::map<std::string, std::vector<std::string>>;

/// Adds an option, or a positional, for each field that the command line has; `words` must outlive the verb.
void add_field_options(CLI::App& verb, const Operation& operation, const std::vector<Field>& fields,
                       FieldWords& words);

/// The operation's value of the words, over the values in `step`. Throws CLI::ValidationError where a word is
/// not its field's, std::runtime_error where the operation refuses the whole.
Action read_action(const Operation& operation, const FieldWords& words);

/// Adds a verb for every operation of the table that works on files: a plan of one step. Its options, their
/// checks and its help come from the operation's fields.
void add_operation_verbs(Program& program);

}  // namespace octotomy::planner::cli
