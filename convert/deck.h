// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "convert/element_faces.h"
#include "convert/tetrahedra.h"
#include "voxel/progress.h"

namespace octotomy::convert {

/// Linear elastic and isotropic.
struct DeckMaterial {
  std::string name = "BONE";
  double youngs_modulus_mpa =
      17000.0;  ///< cortical bone along its long axis; Reilly and Burstein 1975, 17.0 GPa
  double poisson_ratio = 0.3;
};

struct NodeSet {
  std::string name;
  std::vector<std::uint32_t> nodes;  ///< ascending
};

/// A face may be in several surfaces; Gmsh, where elements have one place, then holds it more than once.
struct DeckSurface {
  std::string name;
  std::vector<ElementFace> faces;
};

/// Displacements that a step prescribes: one of each node of a set, or none at all for every node where the
/// list is empty, which holds the set fast.
struct Prescribed {
  std::string node_set;
  std::vector<glm::dvec3> displacement_mm;
};

/// Two surfaces that may touch, part and slide without friction, but not pass through each other.
struct ContactPair {
  std::string name;
  std::string slave, master;  ///< surfaces; the slave should be the softer or finer one
};

/// A value an element, "HU" for example.
struct ElementField {
  std::string name;
  std::vector<double> values;
};

/// What a deck says beside its nodes and elements. Units are mm, N, MPa; frame LPS. The names are letters,
/// digits, '_' and '-', at most 80, beginning with a letter: what Abaqus and CalculiX both take.
struct DeckOptions {
  std::string title;
  std::string element_set = "SOLID";
  std::string surface_node_set = "SURFACE";
  std::vector<DeckMaterial> materials{DeckMaterial{}};
  std::vector<std::uint32_t> material_of_tet;  ///< by number in `materials`; empty: all are the first
  std::vector<NodeSet> node_sets;
  std::vector<DeckSurface> surfaces;
  std::vector<ContactPair> contacts;
  /// Where there are any, the deck ends in a static step, linear but for contact.
  std::vector<Prescribed> prescribed;
  std::vector<ElementField> fields;  ///< written where the format has a place for them
  std::vector<std::string> notes;    ///< lines of the header: versions, plan, quality
  bool msh_2_2 = false;              ///< .msh in Gmsh's version 2.2 instead of 4.1
  /// Ten-node tetrahedra in place of four-node ones (second_order.h): stiff by far less in bending and near
  /// incompressibility, with some seven times the nodes.
  bool second_order = false;
  voxel::Progress progress{};  ///< of the writing, about
};

/// Writes a deck as its extension says, beside and renamed into place:
/// .inp  Abaqus and CalculiX: C3D4 or C3D10 elements, sets of elements by region and material, sets of
///       nodes, surfaces, materials with their sections, and the static step of what is prescribed.
/// .feb  FEBio 4: the same, prescribed displacements as maps over node sets.
/// .vtu  VTK unstructured grid of tetrahedra, appended raw data; points in double precision, the nodes of the
///       surface marked by the point array `surface`, sets by arrays of their own; regions, materials and
///       fields by elements, surfaces by bits of elements, bit i for the face opposite corner i.
/// .msh  Gmsh 4.1 or 2.2, text: a physical volume a region, a physical surface a surface.
/// .node TetGen's .node, .ele and .face, the last with the whole surface; linear elements only.
/// Throws std::runtime_error with path and reason; std::invalid_argument for another extension, no
/// tetrahedra, an element without a node, sets and lists that do not fit, or options that a solver would
/// refuse; Stopped where `progress` asks for it, and then there is no file.
void write_deck(const Tetrahedra& tetrahedra, const std::filesystem::path& path,
                const DeckOptions& options = {});

/// Extensions that write_deck() takes, for a refusal: ".inp, .feb, .vtu, .msh or .node".
const std::string& deck_extensions();
bool is_deck(const std::filesystem::path& path);

}  // namespace octotomy::convert
