// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace octotomy::planner::cli {

/// Sorts the program's verbs into groups by task, in which its help lists them. Precondition: all verbs have
/// been added. Throws CLI::OptionNotFound if a name in the table is not a verb. A verb that is not in the
/// table stays in the help's group "Subcommands", which a test refuses.
void group_verbs(CLI::App& app);

}  // namespace octotomy::planner::cli
