// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace octotomy::planner::cli {

/// Documentation generated from the program's verbs, options and examples. `kind` is "man" for a manual page
/// in troff, or "bash" or "zsh" for a script that completes command lines. Throws CLI::ValidationError for
/// other words.
std::string manual(const CLI::App& app, const std::string& kind);

/// Adds the hidden option --manual KIND, which prints manual() and exits successfully.
void add_manual(CLI::App& app);

}  // namespace octotomy::planner::cli
