// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace octotomy::planner::cli {

/// Sorts the program's verbs into groups by task, under which the help lists them. Precondition: all verbs
/// have been added. Throws CLI::OptionNotFound if the table of groups names a verb that does not exist. A
/// verb that is missing in the table stays in the help's group "Subcommands"; a test refuses this.
void group_verbs(CLI::App& app);

}  // namespace octotomy::planner::cli
