// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <map>

#include "convert/deck/deck_format.h"

// FEBio's XML, version 4.0. Numbers begin at 1. A solid domain has one material, so that elements stand in
// blocks by region and material. Source: FEBio user's manual 4, chapter 3, "Free format input".

namespace octotomy::convert {
namespace {

/// A block of elements of one region and one material.
struct Block {
  std::string name;
  std::uint32_t material = 0;
  std::vector<std::uint32_t> tets;
};

std::vector<Block> blocks_of(const Tetrahedra& tetrahedra, const DeckOptions& options) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, Block> blocks;
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t) {
    const std::uint32_t region = region_of(tetrahedra, t);
    const std::uint32_t material = material_of(options, t);
    Block& block = blocks[{region, material}];
    block.name = region_name(region) + "_" + options.materials[material].name;
    block.material = material;
    block.tets.push_back(static_cast<std::uint32_t>(t));
  }
  std::vector<Block> result;
  result.reserve(blocks.size());
  for (auto& [key, block] : blocks) result.push_back(std::move(block));
  return result;
}

void write_list(const std::vector<std::uint32_t>& entries, std::ostream& out) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (i > 0) out << (i % 16 == 0 ? ",\n" : ",");
    out << std::size_t{entries[i]} + 1;
  }
}

void write_on_one_line(const std::vector<std::uint32_t>& nodes, std::ostream& out) {
  for (std::size_t i = 0; i < nodes.size(); ++i) out << (i > 0 ? "," : "") << std::size_t{nodes[i]} + 1;
}

void write_mesh(const Tetrahedra& tetrahedra, const DeckOptions& options, const std::vector<Block>& blocks,
                std::ostream& out) {
  out << "<Mesh>\n<Nodes name=\"" << options.element_set << "\">\n";
  for (std::size_t i = 0; i < tetrahedra.nodes_mm.size(); ++i) {
    const glm::dvec3& p = tetrahedra.nodes_mm[i];
    out << "<node id=\"" << i + 1 << "\">" << full_number(p.x).data() << "," << full_number(p.y).data() << ","
        << full_number(p.z).data() << "</node>\n";
  }
  out << "</Nodes>\n";
  for (const Block& block : blocks) {
    out << "<Elements type=\"" << (tetrahedra.mid_nodes.empty() ? "tet4" : "tet10") << "\" name=\""
        << block.name << "\">\n";
    for (const std::uint32_t t : block.tets) {
      out << "<elem id=\"" << std::size_t{t} + 1 << "\">";
      write_on_one_line(nodes_of(tetrahedra, t), out);
      out << "</elem>\n";
    }
    out << "</Elements>\n";
  }
  const auto node_set = [&](const std::string& name, const std::vector<std::uint32_t>& nodes) {
    if (nodes.empty()) return;
    out << "<NodeSet name=\"" << name << "\">";
    write_list(nodes, out);
    out << "</NodeSet>\n";
  };
  node_set(options.surface_node_set, tetrahedra.boundary_nodes);
  for (const NodeSet& set : options.node_sets) node_set(set.name, set.nodes);
  const char* triangle = tetrahedra.mid_nodes.empty() ? "tri3" : "tri6";
  for (const DeckSurface& surface : options.surfaces) {
    out << "<Surface name=\"" << surface.name << "\">\n";
    for (std::size_t i = 0; i < surface.faces.size(); ++i) {
      out << "<" << triangle << " id=\"" << i + 1 << "\">";
      write_on_one_line(nodes_of(tetrahedra, surface.faces[i]), out);
      out << "</" << triangle << ">\n";
    }
    out << "</Surface>\n";
  }
  for (const ContactPair& pair : options.contacts)
    out << "<SurfacePair name=\"" << pair.name << "\"><primary>" << pair.slave << "</primary><secondary>"
        << pair.master << "</secondary></SurfacePair>\n";
  out << "</Mesh>\n<MeshDomains>\n";
  for (const Block& block : blocks)
    out << "<SolidDomain name=\"" << block.name << "\" mat=\"" << options.materials[block.material].name
        << "\"/>\n";
  out << "</MeshDomains>\n";
}

constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

void write_maps(const DeckOptions& options, std::ostream& out) {
  out << "<MeshData>\n";
  for (const Prescribed& prescribed : options.prescribed)
    for (int axis = 0; axis < 3 && !prescribed.displacement_mm.empty(); ++axis) {
      out << "<NodeData name=\"" << prescribed.node_set << "_"
          << axis_names.at(static_cast<std::size_t>(axis)) << "\" node_set=\"" << prescribed.node_set
          << "\" data_type=\"scalar\">\n";
      for (std::size_t i = 0; i < prescribed.displacement_mm.size(); ++i)
        out << "<node lid=\"" << i + 1 << "\">" << full_number(prescribed.displacement_mm[i][axis]).data()
            << "</node>\n";
      out << "</NodeData>\n";
    }
  out << "</MeshData>\n";
}

void write_boundary(const DeckOptions& options, std::ostream& out) {
  out << "<Boundary>\n";
  for (const Prescribed& prescribed : options.prescribed) {
    const std::string& set = prescribed.node_set;
    if (prescribed.displacement_mm.empty()) {
      out << "<bc name=\"" << set << "_fixed\" node_set=\"" << set
          << "\" type=\"zero displacement\"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof></bc>\n";
      continue;
    }
    for (const char* axis : axis_names)
      out << "<bc name=\"" << set << "_moved_" << axis << "\" node_set=\"" << set
          << "\" type=\"prescribed displacement\"><dof>" << axis << "</dof><value lc=\"1\" type=\"map\">"
          << set << "_" << axis << "</value><relative>0</relative></bc>\n";
  }
  out << "</Boundary>\n<LoadData>\n<load_controller id=\"1\" name=\"whole\" type=\"loadcurve\">"
         "<interpolate>LINEAR</interpolate><extend>CONSTANT</extend><points><pt>0,0</pt><pt>1,1</pt></points>"
         "</load_controller>\n</LoadData>\n";
}

void write_contact_section(const DeckOptions& options, std::ostream& out) {
  if (options.contacts.empty()) return;
  out << "<Contact>\n";
  for (const ContactPair& pair : options.contacts)
    out << "<contact name=\"" << pair.name << "\" type=\"sliding-elastic\" surface_pair=\"" << pair.name
        << "\"><laugon>PENALTY</laugon><auto_penalty>0</auto_penalty><penalty>"
        << full_number(contact_stiffness(options)).data() << "</penalty></contact>\n";
  out << "</Contact>\n";
}

}  // namespace

void write_feb(const Tetrahedra& tetrahedra, const DeckOptions& options, std::ostream& out) {
  const std::vector<Block> blocks = blocks_of(tetrahedra, options);
  out << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<febio_spec version=\"4.0\">\n<!-- "
      << xml_escaped(options.title) << " -->\n<!-- Units: mm, N, MPa. Frame: LPS. -->\n";
  if (!tetrahedra.method.empty()) out << "<!-- Made by: " << xml_escaped(tetrahedra.method) << " -->\n";
  for (const std::string& note : options.notes) out << "<!-- " << xml_escaped(note) << " -->\n";
  out << "<Module type=\"solid\"/>\n<Control><analysis>STATIC</analysis><time_steps>1</time_steps>"
         "<step_size>1</step_size></Control>\n<Material>\n";
  for (std::size_t m = 0; m < options.materials.size(); ++m)
    out << "<material id=\"" << m + 1 << "\" name=\"" << options.materials[m].name
        << "\" type=\"isotropic elastic\"><density>1e-9</density><E>"
        << full_number(options.materials[m].youngs_modulus_mpa).data() << "</E><v>"
        << full_number(options.materials[m].poisson_ratio).data() << "</v></material>\n";
  out << "</Material>\n";
  write_mesh(tetrahedra, options, blocks, out);
  write_contact_section(options, out);
  if (!options.prescribed.empty()) {
    write_maps(options, out);
    write_boundary(options, out);
  }
  out << "<Output><plotfile type=\"febio\"><var type=\"displacement\"/><var "
         "type=\"stress\"/><var type=\"reaction forces\"/></plotfile></Output>\n"
         "</febio_spec>\n";
}

}  // namespace octotomy::convert
