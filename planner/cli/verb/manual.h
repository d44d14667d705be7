// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace CLI {
class App;
}  // namespace CLI

namespace octotomy::planner::cli {

/// What the program's options, verbs and examples are for people and shells, from the options themselves:
/// "man" gives a page in troff, "bash" and "zsh" a completion. Throws CLI::ValidationError for another kind.
std::string manual(const CLI::App& app, const std::string& kind);

/// Adds the option --manual KIND, which help does not show: prints manual() and ends with success.
void add_manual(CLI::App& app);

}  // namespace octotomy::planner::cli
