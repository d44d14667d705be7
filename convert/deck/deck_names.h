// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "convert/deck/deck.h"

namespace octotomy::convert {

/// Whether Abaqus and CalculiX take it as a name: a letter, then letters, digits, '_' and '-', at most 80.
bool is_solver_name(const std::string& name);

/// Whether a node set of the caller's may not have this name, because a deck's own sets have it: "SURFACE",
/// "SOLID" and "NSOLID". Case does not tell names apart: Abaqus and CalculiX read all in capitals.
bool is_own_node_set_name(const std::string& name, const DeckOptions& options = {});

/// Two names of a deck that a solver would take for one: "node sets 'Pin' and 'PIN'". Node sets are held
/// against each other and against the deck's own; so are surfaces, also against regions, sets of elements and
/// fields; materials and contact pairs against each other. None where all names differ by more than case.
std::optional<std::string> name_clash(const Tetrahedra& tetrahedra, const DeckOptions& options);

/// Renames node sets, surfaces, materials and contact pairs, and what refers to them, so that name_clash() is
/// none and every name begins with a letter and has at most 80 characters: later ones get "_2", "_3", ...
/// Returns a line for each changed name.
std::vector<std::string> make_names_unique(const Tetrahedra& tetrahedra, DeckOptions& options);

}  // namespace octotomy::convert
