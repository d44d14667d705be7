// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "convert/tet/tetrahedra.h"
#include "voxel/space/progress.h"

namespace octotomy::convert {

/// The displacements of the last step in CalculiX's .frd result, by node of the deck that write_deck() wrote
/// (entry 0 belongs to its node 1); none for nodes that the result lacks. Millimetres, LPS. Throws voxel::Error
/// (Input) with path and line if the file cannot be read, holds no displacements, a node number beyond
/// `node_count`, or a line of another format; voxel::Stopped. Memory: 32 bytes a node.
std::vector<std::optional<glm::dvec3>> read_displacements(const std::filesystem::path& frd,
                                                          std::size_t node_count,
                                                          const voxel::Progress& progress = {});

/// A solved deck from CalculiX's .frd result: nodes with the six digits of that file, linear tetrahedra
/// (eight for each of second order), and the displacements of the last step.
struct SolvedDeck {
  Tetrahedra tetrahedra;
  std::vector<glm::dvec3> displacement_mm;
};
/// Throws as read_displacements(), and if an element is not a tetrahedron, names a node that the file lacks,
/// or a node has no displacement. Memory: the file's nodes and elements.
SolvedDeck read_solved_deck(const std::filesystem::path& frd, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
