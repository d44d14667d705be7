// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/align/mirror.h"
#include "voxel/space/progress.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::planner {

/// A place that a person has yet to look at.
struct LandmarkGuess {
  std::string name;
  glm::dvec3 p_mm{0.0};  ///< LPS
  /// How far it moved while its rule was asked again, the farthest answer aside: with the head pitched by up
  /// to 5 degrees either way, at other heights, about mid-planes of other shares of the surface; a map's step
  /// more.
  double within_mm = 0.0;
};

struct SkullGuess {
  brep::MirrorFit mid_plane;
  std::vector<LandmarkGuess> found;                          ///< by name
  std::vector<std::pair<std::string, std::string>> missing;  ///< names, each with the reason
};

/// A first guess of a skull's landmarks from its symmetry and its extremal points, as the rules in
/// skull_profile.h and face_rules.h say them. The patient's up, left and front are the scan's, to some 20
/// degrees. Names are those of procedures and cephalometry. What two trials do
/// not find, or far off, is missing. `surface` is the same bone. Throws std::runtime_error where there is no
/// mid-plane or no face, as of what is no skull; voxel::Stopped. Cost: three mirror fits, twenty-one
/// pictures.
SkullGuess guess_landmarks(const voxel::DrawnObject& bone, const brep::Mesh& surface,
                           const voxel::Progress& progress = {});

}  // namespace octotomy::planner
