// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/deck_format.h"

// TetGen's files; numbers begin at 1. The attribute of an element is its region.

namespace octotomy::convert {
namespace {

void write_header(const DeckOptions& options, std::ostream& out) {
  std::string title = options.title;
  for (char& c : title)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  out << tetgen_title_begin << title << tetgen_title_end << "\n";
}

}  // namespace

void write_tetgen_node(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  write_header(options, out);
  out << tetrahedra.nodes_mm.size() << " 3 0 0\n";
  for (std::size_t i = 0; i < tetrahedra.nodes_mm.size(); ++i) {
    const glm::dvec3& p = tetrahedra.nodes_mm[i];
    out << i + 1 << " " << full_number(p.x).data() << " " << full_number(p.y).data() << " "
        << full_number(p.z).data() << "\n";
  }
}

void write_tetgen_ele(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  write_header(options, out);
  out << tetrahedra.tets.size() << " 4 1\n";
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
    out << t + 1;
    for (const std::uint32_t corner : tetrahedra.tets[t]) out << " " << std::size_t{corner} + 1;
    out << " " << region_of(tetrahedra, t) + 1 << "\n";
  }
}

void write_tetgen_face(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  write_header(options, out);
  const std::vector<ElementFace> faces = surface_faces(tetrahedra);
  out << faces.size() << " 1\n";
  for (std::size_t f = 0; f < faces.size(); ++f) {
    out << f + 1;
    for (const std::uint32_t corner : corners_of(tetrahedra, faces[f])) out << " " << std::size_t{corner} + 1;
    out << " " << region_of(tetrahedra, faces[f].tet) + 1 << "\n";
  }
}

}  // namespace octotomy::convert
