// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/align/mirror.h"
#include "voxel/space/progress.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::planner {

/// A guessed position, which a person has to check.
struct LandmarkGuess {
  std::string name;
  glm::dvec3 p_mm{0.0};  ///< LPS
  /// Its largest expected error: 0.7 edges of the coarsest voxel, plus the root of the sum of the squares of:
  /// - 1.3 times the largest distance of the trials' results, in each of which some assumption is changed:
  ///   the head's pitch by up to 6 degrees either way (lines of faces differ by about 4 degrees from the
  ///   Frankfurt plane), heights, the map's cells, the threshold, the share of the surface for the mid-plane;
  /// - the doubt of its rule (FoundPlaces::doubt_mm): the length over which its extremum is flat, half the
  ///   distance to a second rule's result, the difference of both sides; for midline_... points the distance
  ///   between the two halves, MirrorFit::rms_mm, and the displacement of the plane there by a rotation of
  ///   mid_plane_within_deg;
  /// - for a point of the middle, half of its distance from the mid-plane. The two factors are chosen, not
  ///   derived; random heads of closed form test the result. Differences between human observers are not
  ///   included: the operation adds them for each landmark (skull.landmarks.json).
  double within_mm = 0.0;
};

struct SkullGuess {
  brep::MirrorFit mid_plane;
  /// The largest expected error of the mid-plane's normal: 0.5 degrees plus 1.3 times the largest angle to
  /// the planes that are fitted with other shares of the surface.
  double mid_plane_within_deg = 0.0;
  std::vector<LandmarkGuess> found;                          ///< by name
  std::vector<std::pair<std::string, std::string>> missing;  ///< names of landmarks that were not found, each
                                                             ///< with the reason
  std::vector<std::string> findings;
};

/// A first guess of a skull's landmarks from its symmetry and its extremal points, by the rules of
/// skull_profile.h and face_rules.h, on the patient's bone only (head_part.h). `surface` is the surface of
/// the same bone. The patient's up, left and front must agree with the scan's axes within about 20 degrees;
/// the pitch is determined from nose, orbits and arches. Landmarks have the names that procedures and
/// cephalometry use. A landmark is missing if two trials do not find it or find it far away, or if its
/// position is implausible (plausible.h). Throws std::runtime_error if there is no mid-plane or no face, for
/// example if the object is not a skull; voxel::Stopped. Cost: three mirror fits, three pictures and about
/// forty of a quarter of their pixels.
SkullGuess guess_landmarks(const voxel::DrawnObject& bone, const brep::Mesh& surface,
                           const voxel::Progress& progress = {});

}  // namespace octotomy::planner
