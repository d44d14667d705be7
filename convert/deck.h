// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "convert/tetrahedralise.h"

namespace octotomy::convert {

/// What a deck says beside its nodes and elements. Units are mm, N, MPa; frame LPS. The names are letters,
/// digits, '_' and '-', at most 80, beginning with a letter: what Abaqus and CalculiX both take.
struct DeckOptions {
  std::string title;
  std::string element_set = "SOLID";
  std::string surface_node_set = "SURFACE";
  std::string material = "BONE";
  double youngs_modulus_mpa =
      17000.0;  ///< cortical bone along its long axis; Reilly and Burstein 1975, 17.0 GPa
  double poisson_ratio = 0.3;
};

/// Writes a deck as its extension says, beside and renamed into place:
/// .inp  Abaqus and CalculiX: C3D4 elements and their set, the surface's nodes as a set, an elastic material,
///       a solid section. No step: loads and supports are the analyst's.
/// .vtu  VTK unstructured grid of tetrahedra, appended raw data; points in double precision, the nodes of the
///       surface marked by the point array `surface`.
/// Throws std::runtime_error with path and reason; std::invalid_argument for another extension, no
/// tetrahedra, an element without a node, or options that a solver would refuse.
void write_deck(const Tetrahedra& tetrahedra, const std::filesystem::path& path,
                const DeckOptions& options = {});

}  // namespace octotomy::convert
