// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/mesh.h"
#include "verify/certificate/certificate.h"
#include "verify/certificate/general_position.h"
#include "voxel/solid/expression.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

/// Both kernels' answers to a Boolean expression of sets of voxels, on a refined lattice of unit voxels whose
/// corner is the origin (GeneralPosition).
struct ExactAnswers {
  voxel::Octree octree;
  /// The mesh kernel's answer: solids with disjoint insides. There is one solid unless the expression has an
  /// exclusive or, whose result no manifold surface bounds.
  std::vector<brep::Mesh> solids;
  std::string operation;
  double unit_mm3 = 1.0;              ///< volume of a refined voxel in the patient
  glm::dmat4 lps_from_unit{1.0};      ///< LPS millimetres from refined voxels; less than a voxel off
  bool areas_add_up = true;           ///< whether no two of the solids share a face
  double shift_mm = 0.0;              ///< sum over all corefinements, in refined voxels; above 0 fails
  std::vector<std::string> findings;  ///< of the corefinements
};

/// Evaluates the expression in both kernels: in one walk over octrees, and by corefinement of cuberilles.
/// Precondition: the leaves are octrees of one universe, moved at most by whole voxels. An octree that occurs
/// twice counts as two sets. Parts outside the universe are cut off. Throws std::invalid_argument for any
/// other leaf, with its number, and any other motion; as general_position() and brep::boolean();
/// voxel::Stopped. Cost: see general_position(); one corefinement for each operator, about 10 us a triangle.
ExactAnswers exact_answers(const voxel::Expression& expression, const voxel::Progress& progress = {});

/// Compares both answers with tolerance zero (tier Exact): the mesh's volume as an integer, the voxels whose
/// centre lies inside the mesh, and the area, up to rounding, if `areas_add_up`. The mesh's surface must be
/// closed and oriented. FAIL if anything differs.
Certificate certify_exact(const ExactAnswers& answers);

/// The volume of solids with corners on the unit lattice, as an integer. Triangles with integer corners are
/// summed in 64-bit integers. The other corners are roundings of points on lines between lattice points; they
/// change the sum by far less than a half (see the source). None if the sum is not an integer.
std::optional<std::int64_t> whole_volume(const std::vector<brep::Mesh>& solids);

}  // namespace octotomy::verify
