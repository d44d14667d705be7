// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "convert/deck/deck.h"

namespace octotomy::convert {

// One writer for each format. deck.cpp opens and checks the stream. Elements with nodes on their sides are of
// second order.

void write_inp(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_feb(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_vtu(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_msh(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_tetgen_node(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_tetgen_ele(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);
void write_tetgen_face(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out);

/// The text before and after the title in the first line of TetGen's files.
inline constexpr std::string_view tetgen_title_begin = "# ", tetgen_title_end = "; mm, LPS";

/// A number with 12 digits. CalculiX reads at most 20 characters of a field; sign, point and exponent make at
/// most 19.
std::array<char, 32> deck_number(double value);
/// All digits of a double.
std::array<char, 32> full_number(double value);

/// "REGION1", ... by the number of the element's region.
std::string region_name(std::uint32_t region);
/// One more than the largest region number.
std::uint32_t region_count(const Tetrahedra& tetrahedra);
/// An element's nodes: corners, then the middles of sides if there are any. Most formats use this order.
std::vector<std::uint32_t> nodes_of(const Tetrahedra& tetrahedra, std::size_t tet);
/// A face's nodes: corners, then the middles of sides if there are any.
std::vector<std::uint32_t> nodes_of(const Tetrahedra& tetrahedra, const ElementFace& face);
std::uint32_t material_of(const DeckOptions& options, std::size_t tet);
/// Contact pressure per overclosure, MPa a millimetre: ten times the largest Young's modulus; CalculiX's
/// manual advises 5 to 50 times. The pressure that strains an element by 1 % then makes surfaces overlap by
/// at most 0.001 mm.
double contact_stiffness(const DeckOptions& options);
/// Text escaped for XML: it cannot end a comment or break a line.
std::string xml_escaped(const std::string& text);

}  // namespace octotomy::convert
