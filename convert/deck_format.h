// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <vector>

#include "convert/deck.h"

namespace octotomy::convert {

// One writer a format, each to a stream that deck.cpp opens, checks and renames into place. Elements are of
// second order where they have nodes on their sides.

void write_inp(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_feb(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_vtu(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_msh(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_tetgen_node(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_tetgen_ele(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_tetgen_face(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);

/// What writers share: numbers as the solvers read them, CalculiX at most 20 characters of a field: 12
/// digits, sign, point and exponent are 19.
std::array<char, 32> deck_number(double value);
/// All digits of a double, for formats that read them.
std::array<char, 32> full_number(double value);

/// "REGION1", ... by the element's region.
std::string region_name(std::uint32_t region);
/// How many regions there are: one more than the largest number.
std::uint32_t region_count(const Tetrahedra& tetrahedra);
/// An element's nodes as most formats have them: corners, then the middles of sides, if any.
std::vector<std::uint32_t> nodes_of(const Tetrahedra& tetrahedra, std::size_t tet);
/// A face's nodes: corners, then the middles of sides, if any.
std::vector<std::uint32_t> nodes_of(const Tetrahedra& tetrahedra, const ElementFace& face);
std::uint32_t material_of(const DeckOptions& options, std::size_t tet);
/// Pressure by overclosure of contact, MPa a millimetre: ten times the largest Young's modulus, of the 5 to
/// 50 that CalculiX's manual advises. A tenth of a millimetre's strain over ten millimetres then overlaps by
/// under a hundredth of it.
double contact_stiffness(const DeckOptions& options);
/// Text that cannot end a comment or break a line.
std::string xml_escaped(const std::string& text);

}  // namespace octotomy::convert
