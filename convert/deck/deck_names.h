// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "convert/deck/deck.h"

namespace octotomy::convert {

/// Whether Abaqus and CalculiX accept a name: a letter, then letters, digits, '_' and '-', at most 80.
bool is_solver_name(const std::string& name);

/// Whether this name is reserved for a deck's own sets, so that the caller's node sets may not have it:
/// "SURFACE", "SOLID" and "NSOLID". Case does not distinguish names, because Abaqus and CalculiX convert them
/// to capitals.
bool is_own_node_set_name(const std::string& name, const DeckOptions& options = {});

/// Two names of a deck that a solver would not distinguish: "node sets 'Pin' and 'PIN'". Compares node sets
/// with each other and with the deck's own; surfaces with each other, the deck's own, regions, sets of
/// elements and fields; materials with each other; contact pairs with each other. None if all names differ by
/// more than case.
std::optional<std::string> name_clash(const Tetrahedra& tetrahedra, const DeckOptions& options);

/// Renames node sets, surfaces, materials and contact pairs, and updates references to them, so that
/// name_clash() returns none and every name begins with a letter and has at most 80 characters. Of equal
/// names, later ones get "_2", "_3", ... Returns a line for each changed name.
std::vector<std::string> make_names_unique(const Tetrahedra& tetrahedra, DeckOptions& options);

}  // namespace octotomy::convert
