// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace octotomy::planner::cli {

/// Documentation generated from the program's options, verbs and examples: "man" is a page in troff, "bash"
/// and "zsh" are completions. Throws CLI::ValidationError for another kind.
std::string manual(const CLI::App& app, const std::string& kind);

/// Adds the hidden option --manual KIND, which prints manual() and exits successfully.
void add_manual(CLI::App& app);

}  // namespace octotomy::planner::cli
