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
  /// How far off it may be: 0.7 edges of the coarsest voxel, and the root of the sum of these squares:
  /// - 1.3 times the farthest answer when its rule is applied again with one assumption or more changed: the
  ///   head pitched by up to 6 degrees either way (faces' own lines differ by some 4 from the Frankfurt
  ///   plane), other heights, a coarser map, a higher threshold, mid-planes of other shares of the surface;
  /// - what the rule itself leaves open (FoundPlaces::doubt_mm): the length over which its extremum is flat,
  ///   half the way to a second rule's answer, the difference of both sides; of midline_... points how
  ///   far the two halves lie apart, MirrorFit::rms_mm, and how far a plane turned by mid_plane_within_deg
  ///   lies off there;
  /// - of a point of the middle, half of how far it lies beside the mid-plane.
  /// The two factors are chosen, not derived; random heads of closed form test the result. What observers
  /// differ by in a name's meaning is not in it: the operation adds it by name (skull.landmarks.json).
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
/// left and front are the scan's, to some 20 degrees; the pitch is found from nose, orbits and arches. Names
/// are those of procedures and cephalometry. What two trials do not find, or far off, and what lies as in no
/// face (plausible.h) is missing. `surface` is the same bone. Throws std::runtime_error where there is no
/// mid-plane or no face, as of what is no skull; voxel::Stopped. Cost: three mirror fits, three pictures and
/// some forty of a quarter of their pixels.
SkullGuess guess_landmarks(const voxel::DrawnObject& bone, const brep::Mesh& surface,
                           const voxel::Progress& progress = {});

}  // namespace octotomy::planner
