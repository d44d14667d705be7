// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>

#include "convert/deck/deck_format.h"

// Gmsh's MSH text, versions 4.1 and 2.2. A region is written as a volume and a surface as a face, each with a
// physical group of that name. The format can hold node sets only as points, so they are left out. Source:
// Gmsh reference manual, section "MSH file format".

namespace octotomy::convert {
namespace {

int triangle_type(const Tetrahedra& tetrahedra) {
  return tetrahedra.mid_nodes.empty() ? 2 : 9;
}
int tetrahedron_type(const Tetrahedra& tetrahedra) {
  return tetrahedra.mid_nodes.empty() ? 4 : 11;
}

/// Gmsh exchanges the middles of the last two sides.
std::vector<std::uint32_t> nodes_by_gmsh(const Tetrahedra& tetrahedra, std::size_t tet) {
  std::vector<std::uint32_t> nodes = nodes_of(tetrahedra, tet);
  if (!tetrahedra.mid_nodes.empty()) std::swap(nodes[8], nodes[9]);
  return nodes;
}

std::vector<std::vector<std::uint32_t>> tets_by_region(const Tetrahedra& tetrahedra) {
  std::vector<std::vector<std::uint32_t>> regions(region_count(tetrahedra));
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t)
    regions[region_of(tetrahedra, t)].push_back(static_cast<std::uint32_t>(t));
  return regions;
}

void write_names(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  const std::uint32_t regions = region_count(tetrahedra);
  out << "$PhysicalNames\n" << regions + options.surfaces.size() << "\n";
  for (std::size_t s = 0; s < options.surfaces.size(); ++s)
    out << "2 " << s + 1 << " \"" << options.surfaces[s].name << "\"\n";
  for (std::uint32_t r = 0; r < regions; ++r)
    out << "3 " << r + 1 << " \"" << (regions == 1 ? options.element_set : region_name(r)) << "\"\n";
  out << "$EndPhysicalNames\n";
}

void write_point(const glm::dvec3& p, std::ostream& out) {
  out << full_number(p.x).data() << " " << full_number(p.y).data() << " " << full_number(p.z).data();
}

void write_nodes(const std::vector<std::uint32_t>& nodes, std::ostream& out) {
  for (const std::uint32_t node : nodes) out << " " << std::size_t{node} + 1;
  out << "\n";
}

/// Writes every entity with the bounding box of all nodes. A reader can compute tighter boxes from the nodes.
void write_entities(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  glm::dvec3 low = tetrahedra.nodes_mm.front();
  glm::dvec3 high = low;
  for (const glm::dvec3& p : tetrahedra.nodes_mm) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const std::uint32_t regions = region_count(tetrahedra);
  out << "$Entities\n0 0 " << options.surfaces.size() << " " << regions << "\n";
  const auto entity = [&](std::size_t tag) {
    out << tag << " ";
    write_point(low, out);
    out << " ";
    write_point(high, out);
    out << " 1 " << tag << " 0\n";
  };
  for (std::size_t s = 1; s <= options.surfaces.size(); ++s) entity(s);
  for (std::size_t r = 1; r <= regions; ++r) entity(r);
  out << "$EndEntities\n";
}

void write_4_1(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  write_names(tetrahedra, options, out);
  write_entities(tetrahedra, options, out);
  const std::size_t nodes = tetrahedra.nodes_mm.size();
  // Lists all nodes under the first volume: the format lists each node once, and nodes on an interface belong
  // to several volumes.
  out << "$Nodes\n1 " << nodes << " 1 " << nodes << "\n3 1 0 " << nodes << "\n";
  for (std::size_t i = 1; i <= nodes; ++i) out << i << "\n";
  for (const glm::dvec3& p : tetrahedra.nodes_mm) {
    write_point(p, out);
    out << "\n";
  }
  out << "$EndNodes\n";
  const std::vector<std::vector<std::uint32_t>> regions = tets_by_region(tetrahedra);
  std::size_t elements = tetrahedra.tets.size();
  std::size_t groups = 0;
  for (const auto& tets : regions) groups += !tets.empty();
  for (const DeckSurface& surface : options.surfaces) {
    elements += surface.faces.size();
    groups += !surface.faces.empty();
  }
  out << "$Elements\n" << groups << " " << elements << " 1 " << elements << "\n";
  std::size_t number = 0;
  for (std::size_t s = 0; s < options.surfaces.size(); ++s) {
    if (options.surfaces[s].faces.empty()) continue;
    out << "2 " << s + 1 << " " << triangle_type(tetrahedra) << " " << options.surfaces[s].faces.size()
        << "\n";
    for (const ElementFace& face : options.surfaces[s].faces) {
      out << ++number;
      write_nodes(nodes_of(tetrahedra, face), out);
    }
  }
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (regions[r].empty()) continue;
    out << "3 " << r + 1 << " " << tetrahedron_type(tetrahedra) << " " << regions[r].size() << "\n";
    for (const std::uint32_t t : regions[r]) {
      out << ++number;
      write_nodes(nodes_by_gmsh(tetrahedra, t), out);
    }
  }
  out << "$EndElements\n";
}

void write_2_2(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  write_names(tetrahedra, options, out);
  out << "$Nodes\n" << tetrahedra.nodes_mm.size() << "\n";
  for (std::size_t i = 0; i < tetrahedra.nodes_mm.size(); ++i) {
    out << i + 1 << " ";
    write_point(tetrahedra.nodes_mm[i], out);
    out << "\n";
  }
  std::size_t elements = tetrahedra.tets.size();
  for (const DeckSurface& surface : options.surfaces) elements += surface.faces.size();
  out << "$EndNodes\n$Elements\n" << elements << "\n";
  std::size_t number = 0;
  for (std::size_t s = 0; s < options.surfaces.size(); ++s)
    for (const ElementFace& face : options.surfaces[s].faces) {
      out << ++number << " " << triangle_type(tetrahedra) << " 2 " << s + 1 << " " << s + 1;
      write_nodes(nodes_of(tetrahedra, face), out);
    }
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
    const std::uint32_t region = region_of(tetrahedra, t) + 1;
    out << ++number << " " << tetrahedron_type(tetrahedra) << " 2 " << region << " " << region;
    write_nodes(nodes_by_gmsh(tetrahedra, t), out);
  }
  out << "$EndElements\n";
}

void write_fields(const DeckOptions& options, std::size_t tets, std::ostream& out) {
  std::size_t first = 1;
  for (const DeckSurface& surface : options.surfaces) first += surface.faces.size();
  // With several regions in version 4.1, elements are ordered by region, so fields are left out of this
  // format.
  for (const ElementField& field : options.fields) {
    out << "$ElementData\n1\n\"" << field.name << "\"\n1\n0\n3\n0\n1\n" << tets << "\n";
    for (std::size_t t = 0; t < tets; ++t)
      out << first + t << " " << full_number(field.values[t]).data() << "\n";
    out << "$EndElementData\n";
  }
}

}  // namespace

void write_msh(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  (options.msh_2_2 ? write_2_2 : write_4_1)(tetrahedra, options, out);
  if (options.msh_2_2 || region_count(tetrahedra) == 1) write_fields(options, tetrahedra.tets.size(), out);
}

}  // namespace octotomy::convert
