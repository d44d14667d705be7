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
  /// - 1.3 times the farthest answer when its rule is applied again with one assumption or more changed: the
  ///   head pitched by up to 6 degrees either way (faces' own lines differ by some 4 from the Frankfurt
  ///   plane), other heights, a coarser map, a higher threshold, mid-planes of other shares of the surface;
  /// - the rule's own doubt (FoundPlaces::doubt_mm): the length over which its extremum is flat, half the way
  ///   to a second rule's answer, the difference of both sides; for midline_... points the distance between
  ///   the two halves, MirrorFit::rms_mm, and the displacement of the plane there by a rotation of
  ///   mid_plane_within_deg;
  /// - for a point of the middle, half of its distance from the mid-plane. The two factors are chosen, not
  ///   derived; random heads of closed form test the result. Differences between observers on the meaning of
  ///   a name are not included: the operation adds them by name (skull.landmarks.json).
  double within_mm = 0.0;
};

struct SkullGuess {
  brep::MirrorFit mid_plane;
  /// The largest expected error of the mid-plane's normal: half a degree plus 1.3 times the widest angle to
  /// the planes from other shares of the surface.
  double mid_plane_within_deg = 0.0;
  std::vector<LandmarkGuess> found;                          ///< by name
  std::vector<std::pair<std::string, std::string>> missing;  ///< names, each with the reason
  std::vector<std::string> findings;
};

/// A first guess of a skull's landmarks from its symmetry and its extremal points, by the rules of
/// skull_profile.h and face_rules.h, on the patient's bone only (head_part.h). `surface` is the surface of
/// the same bone. The patient's up, left and front must agree with the scan's axes within about 20 degrees;
/// the pitch is determined from nose, orbits and arches. Names are those of procedures and cephalometry.
/// A landmark is missing where two trials do not find it or find it far away, or where its position is
/// implausible (plausible.h). Throws std::runtime_error where there is no mid-plane or no face, as for an
/// object that is not a skull; voxel::Stopped. Cost: three mirror fits, three pictures and about forty of a
/// quarter of their pixels.
SkullGuess guess_landmarks(const voxel::DrawnObject& bone, const brep::Mesh& surface,
                           const voxel::Progress& progress = {});

}  // namespace octotomy::planner
