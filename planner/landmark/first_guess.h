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
  /// How far off it may be, calibrated on random heads of closed form: from the farthest answer when its rule
  /// is applied again (head pitched by up to 6 degrees either way, other heights, a coarser map, a higher
  /// threshold, mid-planes of other shares of the surface), the length over which its extremum is flat, the
  /// disagreement of two rules, that of the two sides, and the size of a voxel.
  double within_mm = 0.0;
};

struct SkullGuess {
  brep::MirrorFit mid_plane;
  /// How far the mid-plane's normal may be off: the widest angle between planes of other shares of the
  /// surface, and a floor of half a degree.
  double mid_plane_within_deg = 0.0;
  std::vector<LandmarkGuess> found;                          ///< by name
  std::vector<std::pair<std::string, std::string>> missing;  ///< names, each with the reason
  std::vector<std::string> findings;
};

/// A first guess of a skull's landmarks from its symmetry and its extremal points, as the rules in
/// skull_profile.h and face_rules.h say them, on the patient's bone alone (head_part.h). The patient's up,
/// left and front are the scan's, to some 20 degrees; the pitch is found from nasion and nasal spine. Names
/// are those of procedures and cephalometry. What two trials do not find, or far off, and what lies as in no
/// face (plausible.h) is missing. `surface` is the same bone. Throws std::runtime_error where there is no
/// mid-plane or no face, as of what is no skull; voxel::Stopped. Cost: three mirror fits, three pictures and
/// some forty of a quarter of their pixels.
SkullGuess guess_landmarks(const voxel::DrawnObject& bone, const brep::Mesh& surface,
                           const voxel::Progress& progress = {});

}  // namespace octotomy::planner
