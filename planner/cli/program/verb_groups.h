// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace CLI {
class App;
}  // namespace CLI

namespace octotomy::planner::cli {

/// Sorts the program's verbs into groups by task, which its help prints one after the other. All verbs have
/// to be added before. Throws CLI::OptionNotFound for a name of the table that is no verb; a verb that the
/// table lacks stays in the help's group "Subcommands", which a test refuses.
void group_verbs(CLI::App& app);

}  // namespace octotomy::planner::cli
