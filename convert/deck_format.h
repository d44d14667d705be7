// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <ostream>

#include "convert/deck.h"

namespace octotomy::convert {

// One writer a format, each to a stream that deck.cpp opens, checks and renames into place.

void write_inp(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_vtu(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);

}  // namespace octotomy::convert
