// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "brep/mesh.h"
#include "verify/certificate.h"
#include "verify/general_position.h"
#include "voxel/expression.h"
#include "voxel/octree.h"

namespace octotomy::verify {

/// Both kernels' answers to a Boolean expression of sets of voxels, on a refined lattice of unit voxels whose
/// corner is the origin (GeneralPosition).
struct ExactAnswers {
  voxel::Octree octree;
  /// Solids whose insides do not meet, together the mesh kernel's answer. One unless the expression has an
  /// exclusive or: no manifold surface bounds that.
  std::vector<brep::Mesh> solids;
  std::string operation;
  double unit_mm3 = 1.0;              ///< volume of a refined voxel in the patient
  bool areas_add_up = true;           ///< no two of the solids share a face
  std::vector<std::string> findings;  ///< of the corefinements
};

/// Evaluates the expression in both kernels: in one walk over octrees, and by corefinement of cuberilles. Its
/// leaves are octrees of one universe, under translations by whole voxels at most; an octree that occurs
/// twice counts as two sets. What leaves the universe is cut off. Throws std::invalid_argument saying which
/// leaf or motion is none of these; as general_position() and brep::boolean(); voxel::Stopped. Cost: see
/// general_position(); a corefinement an operator, about 10 us a triangle.
ExactAnswers exact_answers(const voxel::Expression& expression, const std::stop_token& stop = {});

/// Compares them with tolerance zero (tier Exact): six times the mesh's volume as an integer, its area, and
/// its set of voxels; the mesh's surface must be closed and oriented. Fails where anything differs.
Certificate certify_exact(const ExactAnswers& answers);

/// The volume of solids with corners on the unit lattice, as an integer: from 64-bit integers where all
/// points are whole. Others are roundings of points on straight lines between whole ones, which change the
/// sum by far less than a half (see source). None where the sum is not whole.
std::optional<std::int64_t> whole_volume(const std::vector<brep::Mesh>& solids);

}  // namespace octotomy::verify
