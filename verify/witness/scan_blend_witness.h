// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"
#include "verify/witness/reading.h"

namespace octotomy::verify {

/// The parameters of a step that replaces an object's crowns by those of a scan, as in
/// brep::ScanBlendOptions. LPS.
struct WitnessedScan {
  brep::Triangles scan;  ///< open, wound outward, at its final position on the object
  glm::dvec3 to_roots{0, 0, 1};
  double tips_mm = 0.0, depth_mm = 0.0, blend_mm = 1.0, reach_mm = 1.0;
  std::vector<glm::dvec3> about_mm = {};
  double radius_mm = 0.0;
  double apart_mm = 0.0;  ///< largest distance of a right answer's surface from the scan's or the object's
};

/// A witness of the object with the scan's surface on its crowns. Where only the scan counts, the side of the
/// scan's triangles decides. Where only the object counts, the object's witness decides. Along the border
/// between both, both sides are allowed where scan and object differ. The sides of both kernels are the same,
/// because the voxels are digitised triangles. Empty if the object has no witness. Cost of a reading: some
/// triangles, and a reading of the object where the object decides.
Witness witness_of_scan_blend(Witness object, WitnessedScan asked);

/// Whether a witness was made by witness_of_scan_blend(), and is not a Boolean or a motion of other
/// witnesses.
bool is_scan_blend(const Witness& witness);

}  // namespace octotomy::verify
