// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "convert/tetrahedralise.h"

namespace octotomy::convert {

/// What a deck says beside its nodes and elements. Units are mm, N, MPa; frame LPS.
struct DeckOptions {
  std::string title;
  std::string element_set = "SOLID";
  double youngs_modulus_mpa =
      13700.0;  ///< cortical bone, long-axis mean of Reilly and Burstein 1975 is 17.0 GPa
  double poisson_ratio = 0.3;
};

/// Writes .inp (Abaqus, CalculiX: C3D4, element set, node set of the surface, elastic material), .vtu
/// (unstructured grid, appended raw or ascii) as the extension says. Written beside and renamed into place.
/// Throws std::runtime_error with path and reason, std::invalid_argument for another extension.
void write_deck(const Tetrahedra& tetrahedra, const std::filesystem::path& path,
                const DeckOptions& options = {});

}  // namespace octotomy::convert
