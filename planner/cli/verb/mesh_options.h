// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace CLI {
class App;
}  // namespace CLI

// Options that verbs share if they read meshes.
namespace octotomy::planner::cli {

/// Adds --frame and --unit to a verb, unless it already has an option of that name.
void add_mesh_options(CLI::App& verb);

/// Passes the words of a verb's --frame and --unit to choose_mesh_reading(), which applies them to all meshes
/// read afterwards. Throws as it does.
void choose_mesh_options(const CLI::App& verb);

}  // namespace octotomy::planner::cli
