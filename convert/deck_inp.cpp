// SPDX-License-Identifier: AGPL-3.0-or-later
#include <array>
#include <cstdio>

#include "convert/deck_format.h"

// Abaqus keyword format in the part that CalculiX reads too. Numbers begin at 1. CalculiX reads 20 characters
// of a field: 12 digits, sign, point and exponent are 19.

namespace octotomy::convert {
namespace {

/// Entries a line of a set: the most that both solvers take.
constexpr std::size_t set_line_entries = 16;

std::array<char, 32> number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.12g", value);
  return text;
}

/// The heading is free text, but a line that begins with '*' would be a keyword.
std::string heading(const std::string& title) {
  std::string line = title.empty() ? "Tetrahedra by octotomy" : title;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return " " + line;
}

}  // namespace

void write_inp(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  out << "*HEADING\n" << heading(options.title) << "\n** Units: mm, N, MPa. Frame: LPS.\n";
  if (!tetrahedra.method.empty()) out << "** TetGen " << tetrahedra.method << "\n";

  out << "*NODE, NSET=N" << options.element_set << "\n";
  std::array<char, 128> line{};
  for (std::size_t i = 0; i < tetrahedra.nodes_mm.size(); ++i) {
    const glm::dvec3& p = tetrahedra.nodes_mm[i];
    const int length = std::snprintf(line.data(), line.size(), "%zu, %s, %s, %s\n", i + 1, number(p.x).data(),
                                     number(p.y).data(), number(p.z).data());
    out.write(line.data(), length);
  }

  out << "*ELEMENT, TYPE=C3D4, ELSET=" << options.element_set << "\n";
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
    const auto& [a, b, c, d] = tetrahedra.tets[t];
    const int length =
        std::snprintf(line.data(), line.size(), "%zu, %zu, %zu, %zu, %zu\n", t + 1, std::size_t{a} + 1,
                      std::size_t{b} + 1, std::size_t{c} + 1, std::size_t{d} + 1);
    out.write(line.data(), length);
  }

  if (!tetrahedra.boundary_nodes.empty()) {
    out << "*NSET, NSET=" << options.surface_node_set << "\n";
    for (std::size_t i = 0; i < tetrahedra.boundary_nodes.size(); ++i) {
      const bool ends_line =
          i % set_line_entries == set_line_entries - 1 || i + 1 == tetrahedra.boundary_nodes.size();
      out << std::size_t{tetrahedra.boundary_nodes[i]} + 1 << (ends_line ? "\n" : ", ");
    }
  }

  out << "*MATERIAL, NAME=" << options.material << "\n*ELASTIC\n"
      << number(options.youngs_modulus_mpa).data() << ", " << number(options.poisson_ratio).data() << "\n"
      << "*SOLID SECTION, ELSET=" << options.element_set << ", MATERIAL=" << options.material << "\n";
}

}  // namespace octotomy::convert
