// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "convert/tet/element_faces.h"
#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"

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

/// A face may be in several surfaces. A Gmsh element belongs to one surface only, so the .msh file repeats
/// such a face.
struct DeckSurface {
  std::string name;
  std::vector<ElementFace> faces;
};

/// Prescribed displacements, one for each node of a set. An empty list holds all nodes of the set in place.
struct Prescribed {
  std::string node_set;
  std::vector<glm::dvec3> displacement_mm;
};

/// Two surfaces that may touch, part and slide without friction, but not pass through each other.
struct ContactPair {
  std::string name;
  std::string slave, master;  ///< surfaces; the slave should be the softer or finer one
};

/// One value for each element, "HU" for example.
struct ElementField {
  std::string name;
  std::vector<double> values;
};

/// The content of a deck apart from its nodes and elements. Units are mm, N, MPa; frame LPS. Names are
/// letters, digits, '_' and '-', at most 80, beginning with a letter, as both Abaqus and CalculiX accept, and
/// differ by more than case (deck_names.h).
struct DeckOptions {
  std::string title;
  std::string element_set = "SOLID";
  std::string surface_node_set = "SURFACE";
  std::vector<DeckMaterial> materials{DeckMaterial{}};
  std::vector<std::uint32_t> material_of_tet;  ///< for each element, the number of its material in
                                               ///< `materials`; empty: all have the first
  std::vector<NodeSet> node_sets;
  std::vector<DeckSurface> surfaces;
  std::vector<ContactPair> contacts;
  /// If there are any, the deck ends with a static step, linear except for contact.
  std::vector<Prescribed> prescribed;
  std::vector<ElementField> fields;  ///< written only to formats that support them
  std::vector<std::string> notes;    ///< lines of the header: versions, plan, quality
  bool msh_2_2 = false;              ///< .msh in Gmsh's version 2.2 instead of 4.1
  /// Ten-node tetrahedra in place of four-node ones (second_order.h): far less stiff in bending and near
  /// incompressibility, with about seven times the nodes.
  bool second_order = false;
  voxel::Progress progress{};  ///< of the bytes written, approximately
};

/// Writes a deck in the format of its extension, beside the destination and then renamed into place:
/// .inp  Abaqus and CalculiX: C3D4 or C3D10 elements, sets of elements by region and material, sets of
///       nodes, surfaces, materials with their sections, and a static step with the prescribed displacements.
/// .feb  FEBio 4: the same, prescribed displacements as maps over node sets.
/// .vtu  VTK unstructured grid of tetrahedra, appended raw data; points in double precision, the nodes of the
///       surface marked by the point array `surface`, each set by one array; regions, materials and fields by
///       elements, surfaces by bits of elements, bit i for the face opposite corner i.
/// .msh  Gmsh 4.1 or 2.2, text: a physical volume a region, a physical surface a surface.
/// .node TetGen's .node, .ele and .face, the last with the whole surface; linear elements only.
/// Throws as need_own_deck_files(). Throws std::invalid_argument for another extension, no tetrahedra, an
/// element that names no node, sets and lists that do not match the elements, or options that a solver would
/// refuse; voxel::Error (Input or Resource) with path and reason if a file cannot be written; voxel::Stopped.
/// After a failure no file is left.
void write_deck(const Tetrahedra& tetrahedra, const std::filesystem::path& path,
                const DeckOptions& options = {});

/// The files that write_deck() writes for a path: three for TetGen, otherwise the path alone. Throws as
/// write_deck() for another extension.
std::vector<std::filesystem::path> deck_files(const std::filesystem::path& path);

/// Throws voxel::Error (Input) if one of the deck's files other than `path` exists and was not written by
/// Octotomy, because the caller did not ask to replace it. Call before long work.
void need_own_deck_files(const std::filesystem::path& path);

/// The extensions of write_deck() for messages: ".inp, .feb, .vtu, .msh or .node".
const std::string& deck_extensions();
bool is_deck(const std::filesystem::path& path);

}  // namespace octotomy::convert
