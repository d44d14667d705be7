// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "planner/cli/verb/verb.h"
#include "planner/operation/table/operation.h"

// An operation's fields as options of its verb, and back.
namespace octotomy::planner::cli {

/// The words on the command line, by field.
using FieldWords = std::map<std::string, std::vector<std::string>>;

/// Adds an option, or a positional, for each field that the command line has; `words` must outlive the verb.
void add_field_options(CLI::App& verb, const Operation& operation, const std::vector<Field>& fields,
                       FieldWords& words);

/// The operation's value of the words. Throws CLI::ValidationError where a word is not its field's,
/// std::runtime_error where the operation refuses the whole.
Action read_action(const Operation& operation, const FieldWords& words);

}  // namespace octotomy::planner::cli
