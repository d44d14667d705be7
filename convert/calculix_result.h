// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "convert/tetrahedra.h"
#include "voxel/progress.h"

namespace octotomy::convert {

/// The displacements of the last step in CalculiX's .frd result, by node of the deck that write_deck() made
/// (its node 1 is the first); none for nodes that the result does not hold. Millimetres, LPS. Throws
/// std::runtime_error with path and line where the file cannot be read, holds no displacements, or a line is
/// none of such a result; a node number beyond `node_count` is one. Memory: 32 bytes a node.
/// Throws voxel::Stopped where `progress` asks for it.
std::vector<std::optional<glm::dvec3>> read_displacements(const std::filesystem::path& frd,
                                                          std::size_t node_count,
                                                          const voxel::Progress& progress = {});

/// A deck as CalculiX's .frd result holds it, solved: nodes to the six digits of that file, linear
/// tetrahedra, of which eight stand for one of second order, and the displacements of the last step.
struct SolvedDeck {
  Tetrahedra tetrahedra;
  std::vector<glm::dvec3> displacement_mm;
};
/// Throws std::runtime_error with path and line as read_displacements() does, and where an element is no
/// tetrahedron, stands on a node that the file lacks, or a node has no displacement. Memory: that of
/// the nodes and elements that the file holds.
/// Throws voxel::Stopped where `progress` asks for it.
SolvedDeck read_solved_deck(const std::filesystem::path& frd, const voxel::Progress& progress = {});

}  // namespace octotomy::convert
