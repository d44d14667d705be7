// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/deck/deck.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

#include "convert/deck/deck_format.h"
#include "convert/deck/deck_names.h"
#include "convert/deck/second_order.h"
#include "voxel/space/disk_need.h"
#include "voxel/space/error.h"
#include "voxel/space/file_text.h"
#include "voxel/space/staged_files.h"
#include "voxel/space/write_failure.h"

namespace octotomy::convert {
namespace {

[[noreturn]] void refuse_to_write(const std::filesystem::path& path, const std::string& why) {
  throw voxel::InvalidInput(path.string() + ": " + why);
}

void check_name(const std::filesystem::path& path, const std::string& what, const std::string& name) {
  if (!is_solver_name(name))
    refuse_to_write(
        path,
        what + " '" + name +
            "' is not a name that Abaqus and CalculiX accept: a letter, then letters, digits, '_', '-', at "
            "most 80 in all");
}

void check_nodes(const Tetrahedra& tetrahedra, const std::filesystem::path& path) {
  if (tetrahedra.tets.empty()) refuse_to_write(path, "there are no tetrahedra to write");
  const auto nodes = tetrahedra.nodes_mm.size();
  for (std::size_t t = 0; t < tetrahedra.tets.size(); ++t)
    for (const std::uint32_t node : tetrahedra.tets[t])
      if (node >= nodes)
        refuse_to_write(path, "tetrahedron " + std::to_string(t) + " names node " + std::to_string(node) +
                                  " of " + std::to_string(nodes));
  for (const std::uint32_t node : tetrahedra.boundary_nodes)
    if (node >= nodes)
      refuse_to_write(path,
                      "the surface names node " + std::to_string(node) + " of " + std::to_string(nodes));
  for (const glm::dvec3& p : tetrahedra.nodes_mm)
    if (!std::isfinite(p.x + p.y + p.z)) refuse_to_write(path, "the position of a node is not finite");
  if (!tetrahedra.mid_nodes.empty() && tetrahedra.mid_nodes.size() != tetrahedra.tets.size())
    refuse_to_write(path, "nodes on sides are given for " + std::to_string(tetrahedra.mid_nodes.size()) +
                              " of " + std::to_string(tetrahedra.tets.size()) + " tetrahedra");
  for (const auto& middles : tetrahedra.mid_nodes)
    for (const std::uint32_t node : middles)
      if (node >= nodes)
        refuse_to_write(path, "a side names node " + std::to_string(node) + " of " + std::to_string(nodes));
  if (!tetrahedra.region_of_tet.empty() && tetrahedra.region_of_tet.size() != tetrahedra.tets.size())
    refuse_to_write(path, "regions are stated for " + std::to_string(tetrahedra.region_of_tet.size()) +
                              " of " + std::to_string(tetrahedra.tets.size()) + " tetrahedra");
}

void check_materials(const Tetrahedra& tetrahedra, const std::filesystem::path& path,
                     const DeckOptions& options) {
  if (options.materials.empty()) refuse_to_write(path, "there is no material");
  for (const DeckMaterial& material : options.materials) {
    check_name(path, "material", material.name);
    if (!(material.youngs_modulus_mpa > 0.0) || !std::isfinite(material.youngs_modulus_mpa))
      refuse_to_write(path, "Young's modulus of " + material.name + " must be positive");
    if (!(material.poisson_ratio > -1.0 && material.poisson_ratio < 0.5))
      refuse_to_write(path, "Poisson's ratio of " + material.name + " must lie between -1 and 0.5");
  }
  if (!options.material_of_tet.empty() && options.material_of_tet.size() != tetrahedra.tets.size())
    refuse_to_write(path, "materials are given for " + std::to_string(options.material_of_tet.size()) +
                              " of " + std::to_string(tetrahedra.tets.size()) + " tetrahedra");
  for (const std::uint32_t material : options.material_of_tet)
    if (material >= options.materials.size())
      refuse_to_write(path, "a tetrahedron names a material that does not exist");
}

void check_sets(const Tetrahedra& tetrahedra, const std::filesystem::path& path, const DeckOptions& options) {
  check_name(path, "element set", options.element_set);
  check_name(path, "node set", options.surface_node_set);
  for (const NodeSet& set : options.node_sets) {
    check_name(path, "node set", set.name);
    for (const std::uint32_t node : set.nodes)
      if (node >= tetrahedra.nodes_mm.size())
        refuse_to_write(path, "set " + set.name + " names a node that does not exist");
  }
  for (const DeckSurface& surface : options.surfaces) {
    check_name(path, "surface", surface.name);
    for (const ElementFace& face : surface.faces)
      if (face.tet >= tetrahedra.tets.size() || face.opposite > 3)
        refuse_to_write(path, "surface " + surface.name + " names a face that does not exist");
  }
  for (const ContactPair& pair : options.contacts) {
    check_name(path, "contact pair", pair.name);
    for (const std::string& name : {pair.slave, pair.master})
      if (std::none_of(options.surfaces.begin(), options.surfaces.end(),
                       [&](const DeckSurface& surface) { return surface.name == name; }))
        refuse_to_write(path,
                        "contact pair " + pair.name + " names a surface '" + name + "' that does not exist");
  }
  for (const Prescribed& prescribed : options.prescribed) {
    const auto set = std::find_if(options.node_sets.begin(), options.node_sets.end(),
                                  [&](const NodeSet& s) { return s.name == prescribed.node_set; });
    if (set == options.node_sets.end())
      refuse_to_write(
          path, "displacements are prescribed for a set '" + prescribed.node_set + "' that does not exist");
    if (!prescribed.displacement_mm.empty() && prescribed.displacement_mm.size() != set->nodes.size())
      refuse_to_write(path, "set " + set->name + " has " + std::to_string(set->nodes.size()) + " nodes and " +
                                std::to_string(prescribed.displacement_mm.size()) + " displacements");
    for (const glm::dvec3& u : prescribed.displacement_mm)
      if (!std::isfinite(u.x + u.y + u.z))
        refuse_to_write(path, "a displacement of set " + set->name + " is not finite");
  }
  for (const ElementField& field : options.fields) {
    check_name(path, "field", field.name);
    if (field.values.size() != tetrahedra.tets.size())
      refuse_to_write(path, "field " + field.name + " has " + std::to_string(field.values.size()) +
                                " values for " + std::to_string(tetrahedra.tets.size()) + " tetrahedra");
  }
}

using Writer = void (*)(const Tetrahedra&, const DeckOptions&, std::ostream&);

/// One of a deck's files, and the function that writes it.
struct Part {
  std::filesystem::path path;
  Writer write;
};

std::vector<Part> parts_of(const std::filesystem::path& path) {
  const std::string extension = voxel::extension_of(path);
  if (extension == ".inp") return {{path, write_inp}};
  if (extension == ".feb") return {{path, write_feb}};
  if (extension == ".vtu") return {{path, write_vtu}};
  if (extension == ".msh") return {{path, write_msh}};
  if (extension == ".node" || extension == ".ele" || extension == ".face") {
    const auto with = [&](const char* other) { return std::filesystem::path(path).replace_extension(other); };
    return {{with(".node"), write_tetgen_node},
            {with(".ele"), write_tetgen_ele},
            {with(".face"), write_tetgen_face}};
  }
  refuse_to_write(path,
                  "'" + extension + "' is not a deck that this program writes: use " + deck_extensions());
}

/// Whether a file begins like the TetGen files that write_deck() writes.
bool is_own_tetgen_file(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  std::string line(4096, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(line.data(), static_cast<std::streamsize>(line.size()));
  line.resize(std::min(static_cast<std::size_t>(in.gcount()), line.find('\n')));
  return line.starts_with(tetgen_title_begin) && line.ends_with(tetgen_title_end);
}

/// The approximate size of a deck in bytes, for its progress: text of nodes, elements and entries of sets.
/// Binary parts are smaller.
double bytes_about(const Tetrahedra& tetrahedra, const DeckOptions& options) {
  std::size_t entries = tetrahedra.boundary_nodes.size();
  for (const NodeSet& set : options.node_sets) entries += set.nodes.size();
  for (const DeckSurface& surface : options.surfaces) entries += surface.faces.size();
  for (const Prescribed& prescribed : options.prescribed) entries += 8 * prescribed.displacement_mm.size();
  return 55.0 * static_cast<double>(tetrahedra.nodes_mm.size()) +
         35.0 * static_cast<double>(tetrahedra.tets.size()) + 10.0 * static_cast<double>(entries);
}

/// The smallest size of a deck in any format: "1,0,0,0" for a node, "1,1,2,3,4" for an element.
std::uint64_t least_bytes(const Tetrahedra& tetrahedra) {
  return 8 * tetrahedra.nodes_mm.size() + 10 * tetrahedra.tets.size();
}

/// Counts the bytes written to a deck's files.
class Written {
 public:
  Written(const voxel::Progress& progress, double bytes_about)
      : progress_(progress), bytes_about_(bytes_about) {}

  /// Throws voxel::Stopped.
  void add(std::streamsize bytes) {
    bytes_ += bytes;
    if (bytes_ < next_) return;
    constexpr std::streamsize look_every = 1 << 18;
    next_ = bytes_ + look_every;
    progress_.at(std::min(1.0, static_cast<double>(bytes_) / bytes_about_));
  }

 private:
  const voxel::Progress& progress_;
  double bytes_about_;
  std::streamsize bytes_ = 0, next_ = 0;
};

/// A file that counts the bytes written to it.
class WatchedFile : public std::filebuf {
 public:
  explicit WatchedFile(Written& written) : written_(written) {}

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    written_.add(count);
    return std::filebuf::xsputn(text, count);
  }

 private:
  Written& written_;
};

}  // namespace

const std::string& deck_extensions() {
  static const std::string extensions = ".inp, .feb, .vtu, .msh or .node";
  return extensions;
}

bool is_deck(const std::filesystem::path& path) {
  const std::string extension = voxel::extension_of(path);
  return extension == ".inp" || extension == ".feb" || extension == ".vtu" || extension == ".msh" ||
         extension == ".node" || extension == ".ele" || extension == ".face";
}

std::vector<std::filesystem::path> deck_files(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files;
  for (const Part& part : parts_of(path)) files.push_back(part.path);
  return files;
}

void need_own_deck_files(const std::filesystem::path& path) {
  for (const std::filesystem::path& file : deck_files(path))
    if (file != path && std::filesystem::exists(std::filesystem::symlink_status(file)) &&
        !is_own_tetgen_file(file))
      throw voxel::Error(voxel::ErrorCode::Input,
                         path.string() + ": the deck would replace " + file.string() +
                             ", which Octotomy did not write: move that file away, or choose another name");
}

void write_deck(const Tetrahedra& tetrahedra, const std::filesystem::path& path, const DeckOptions& options) {
  const std::vector<Part> parts = parts_of(path);
  check_nodes(tetrahedra, path);
  check_materials(tetrahedra, path, options);
  check_sets(tetrahedra, path, options);
  if (const auto clash = name_clash(tetrahedra, options))
    refuse_to_write(path, *clash + " have the same name for solvers, which ignore capitals");
  if (options.second_order) {
    if (parts.size() > 1)
      refuse_to_write(path, "TetGen's files hold only linear elements: choose another deck");
    const SecondOrder made = second_order(tetrahedra, options);
    write_deck(made.tetrahedra, path, made.options);
    return;
  }
  need_own_deck_files(path);
  voxel::need_disk(path, least_bytes(tetrahedra));
  voxel::StagedFiles staged_files(path.has_parent_path() ? path.parent_path() : ".");
  Written written(options.progress, bytes_about(tetrahedra, options));
  for (const Part& part : parts) {
    WatchedFile file(written);
    const auto fail = [&](const char* what) {
      const int number = errno;
      throw voxel::Error(voxel::code_of_errno(number), part.path.string() + ": " + what + ": " +
                                                           std::strerror(number) + voxel::way_out_of(number));
    };
    errno = 0;
    if (file.open(staged_files.folder() / part.path.filename(), std::ios::out | std::ios::binary) == nullptr)
      fail("cannot be written");
    std::ostream out(&file);
    out.exceptions(std::ios::badbit);  // otherwise the stream swallows voxel::Stopped
    bool complete = true;
    try {
      part.write(tetrahedra, options, out);
    } catch (const std::ios::failure&) {
      complete = false;
    }
    if (file.close() == nullptr || !complete) fail("cannot be written completely");
  }
  staged_files.commit();
}

std::array<char, 32> deck_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.12g", value);
  return text;
}

std::array<char, 32> full_number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text;
}

std::string region_name(std::uint32_t region) {
  return "REGION" + std::to_string(region + 1);
}

std::uint32_t region_count(const Tetrahedra& tetrahedra) {
  const auto& regions = tetrahedra.region_of_tet;
  return regions.empty() ? 1 : *std::max_element(regions.begin(), regions.end()) + 1;
}

std::vector<std::uint32_t> nodes_of(const Tetrahedra& tetrahedra, std::size_t tet) {
  std::vector<std::uint32_t> nodes(tetrahedra.tets[tet].begin(), tetrahedra.tets[tet].end());
  if (!tetrahedra.mid_nodes.empty())
    nodes.insert(nodes.end(), tetrahedra.mid_nodes[tet].begin(), tetrahedra.mid_nodes[tet].end());
  return nodes;
}

std::vector<std::uint32_t> nodes_of(const Tetrahedra& tetrahedra, const ElementFace& face) {
  const auto corners = corners_of(tetrahedra, face);
  std::vector<std::uint32_t> nodes(corners.begin(), corners.end());
  if (tetrahedra.mid_nodes.empty()) return nodes;
  const auto middles = middles_of(tetrahedra, face);
  nodes.insert(nodes.end(), middles.begin(), middles.end());
  return nodes;
}

double contact_stiffness(const DeckOptions& options) {
  constexpr double moduli = 10.0;
  double largest_mpa = 0.0;
  for (const DeckMaterial& material : options.materials)
    largest_mpa = std::max(largest_mpa, material.youngs_modulus_mpa);
  return moduli * largest_mpa;
}

std::uint32_t material_of(const DeckOptions& options, std::size_t tet) {
  return options.material_of_tet.empty() ? 0 : options.material_of_tet[tet];
}

std::string xml_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else if (c == '-' && !result.empty() && result.back() == '-') {
      result += "&#45;";  // "--" would end the comment
    } else {
      result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return result;
}

}  // namespace octotomy::convert
