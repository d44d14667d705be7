// SPDX-License-Identifier: AGPL-3.0-or-later
#include <bit>
#include <string>
#include <vector>

#include "convert/deck/deck_format.h"

// VTK XML unstructured grid, version 1.0: 64-bit block sizes, raw data appended after the markup.

namespace octotomy::convert {
namespace {

constexpr std::uint8_t vtk_tetra = 10;
constexpr std::uint8_t vtk_quadratic_tetra = 24;

/// Blocks of appended data, each preceded by its size in bytes. Offsets count from the byte after the '_'.
class Appended {
 public:
  template <typename T>
  std::string add(const std::vector<T>& values) {
    std::string offset = std::to_string(bytes_);
    blocks_.push_back({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
    bytes_ += sizeof(std::uint64_t) + values.size() * sizeof(T);
    return offset;
  }
  void write(std::ostream& out) const {
    for (const Block& block : blocks_) {
      const std::uint64_t size = block.size;
      out.write(reinterpret_cast<const char*>(&size), sizeof size);
      out.write(block.data, static_cast<std::streamsize>(block.size));
    }
  }

 private:
  struct Block {
    const char* data;
    std::size_t size;
  };
  std::vector<Block> blocks_;
  std::uint64_t bytes_ = 0;
};

struct Cells {
  std::vector<std::int64_t> connectivity, offsets;
  std::vector<std::uint8_t> types;
};
Cells cells_of(const Tetrahedra& tetrahedra) {
  Cells cells;
  const bool linear = tetrahedra.mid_nodes.empty();
  cells.connectivity.reserve((linear ? 4 : 10) * tetrahedra.tets.size());
  cells.offsets.reserve(tetrahedra.tets.size());
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
    const std::vector<std::uint32_t> nodes = nodes_of(tetrahedra, t);
    cells.connectivity.insert(cells.connectivity.end(), nodes.begin(), nodes.end());
    cells.offsets.push_back(static_cast<std::int64_t>(cells.connectivity.size()));
  }
  cells.types.assign(tetrahedra.tets.size(), linear ? vtk_tetra : vtk_quadratic_tetra);
  return cells;
}

using Marks = std::vector<std::uint8_t>;

/// 1 for each node of a set.
Marks marks_of(const std::vector<std::uint32_t>& nodes, const Tetrahedra& tetrahedra) {
  Marks marks(tetrahedra.nodes_mm.size(), 0);
  for (const std::uint32_t node : nodes) marks[node] = 1;
  return marks;
}

/// For each element, a set bit for each of its faces that is in the surface.
Marks marks_of(const DeckSurface& surface, const Tetrahedra& tetrahedra) {
  Marks marks(tetrahedra.tets.size(), 0);
  for (const ElementFace& face : surface.faces)
    marks[face.tet] = static_cast<std::uint8_t>(marks[face.tet] | (1U << face.opposite));
  return marks;
}

}  // namespace

void write_vtu(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  const Cells cells = cells_of(tetrahedra);
  std::vector<Marks> sets{marks_of(tetrahedra.boundary_nodes, tetrahedra)};
  for (const NodeSet& set : options.node_sets) sets.push_back(marks_of(set.nodes, tetrahedra));
  std::vector<Marks> surfaces;
  for (const DeckSurface& surface : options.surfaces) surfaces.push_back(marks_of(surface, tetrahedra));
  std::vector<std::int32_t> regions;
  std::vector<std::int32_t> materials;
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
    regions.push_back(static_cast<std::int32_t>(region_of(tetrahedra, t)));
    materials.push_back(static_cast<std::int32_t>(material_of(options, t)));
  }
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
  Appended appended;
  const std::string order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  const auto array = [](const std::string& type, const std::string& name, const std::string& offset,
                        const std::string& more = "") {
    return "<DataArray type=\"" + type + "\" Name=\"" + name + "\"" + more +
           " format=\"appended\" offset=\"" + offset + "\"/>\n";
  };
  out << "<?xml version=\"1.0\"?>\n";
  if (!options.title.empty()) out << "<!-- " << xml_escaped(options.title) << " -->\n";
  for (const std::string& note : options.notes) out << "<!-- " << xml_escaped(note) << " -->\n";
  out << "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" << order
      << "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\""
      << tetrahedra.nodes_mm.size() << "\" NumberOfCells=\"" << tetrahedra.tets.size() << "\">\n"
      << "<PointData>\n"
      << array("UInt8", "surface", appended.add(sets[0]));
  for (std::size_t i = 0; i < options.node_sets.size(); ++i)
    out << array("UInt8", options.node_sets[i].name, appended.add(sets[i + 1]));
  out << "</PointData>\n<CellData>\n"
      << array("Int32", "region", appended.add(regions))
      << array("Int32", "material", appended.add(materials));
  for (std::size_t i = 0; i < options.surfaces.size(); ++i)
    out << array("UInt8", options.surfaces[i].name, appended.add(surfaces[i]));
  for (const ElementField& field : options.fields)
    out << array("Float64", field.name, appended.add(field.values));
  out << "</CellData>\n<Points>\n"
      << array("Float64", "Points", appended.add(tetrahedra.nodes_mm), " NumberOfComponents=\"3\"")
      << "</Points>\n<Cells>\n"
      << array("Int64", "connectivity", appended.add(cells.connectivity))
      << array("Int64", "offsets", appended.add(cells.offsets))
      << array("UInt8", "types", appended.add(cells.types))
      << "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  appended.write(out);
  out << "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace octotomy::convert
