// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace CLI {
class App;
}  // namespace CLI

// What the verbs that read meshes have in common.
namespace octotomy::planner::cli {

/// Adds --frame and --unit to a verb's help, where no other option of the verb has that name already.
void add_mesh_options(CLI::App& verb);

/// Passes the words of the verb's --frame and --unit to choose_mesh_reading(). Throws as that does.
void choose_mesh_options(const CLI::App& verb);

}  // namespace octotomy::planner::cli
