// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "planner/cli/verb/verb.h"
#include "planner/operation/table/operation.h"

// Converts the fields of an operation to options of its verb, and the words of a command line to an
// operation's value.
namespace octotomy::planner::cli {

/// For each field's name, the words that the command line gives for it.
using FieldWords = std::map<std::string, std::vector<std::string>>;

/// Adds an option or a positional for each of the fields. `words` receives their words and must outlive the
/// verb.
void add_field_options(CLI::App& verb, const Operation& operation, const std::vector<Field>& fields,
                       FieldWords& words);

/// The operation's value for these words. Throws CLI::ValidationError if a word is invalid for its field, and
/// std::runtime_error if the operation refuses the values together.
Action read_action(const Operation& operation, const FieldWords& words);

}  // namespace octotomy::planner::cli
