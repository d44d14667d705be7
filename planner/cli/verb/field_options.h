// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "planner/cli/verb/verb.h"
#include "planner/operation/table/operation.h"

// Converts an operation's fields to options of its verb, and words to values.
namespace octotomy::planner::cli {

/// The words on the command line, by field.
using FieldWords = std::map<std::string, std::vector<std::string>>;

/// Adds an option or a positional for each field that is available on the command line; `words` must outlive
/// the verb.
void add_field_options(CLI::App& verb, const Operation& operation, const std::vector<Field>& fields,
                       FieldWords& words);

/// The operation's value from the words. Throws CLI::ValidationError if a word is not valid for its field,
/// std::runtime_error if the operation refuses the combination.
Action read_action(const Operation& operation, const FieldWords& words);

}  // namespace octotomy::planner::cli
