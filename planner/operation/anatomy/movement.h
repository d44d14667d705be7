// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "planner/operation/table/object.h"
#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// The point after a motion.
inline glm::dvec3 carried(const glm::dmat4& motion, const glm::dvec3& p_mm) {
  return glm::dvec3(motion * glm::dvec4(p_mm, 1.0));
}

/// What each moved object's last step moved, in the order of the objects: the motion, its turns, the
/// displacement of the object's centroid and of the landmarks that lie on it, in words and along the head's
/// directions; where earlier steps moved the object, too, the displacements since the scan. Landmarks go with
/// objects as moved_landmarks() says. Cost: some small Booleans a landmark and object.
nlohmann::ordered_json movements_json(const Objects& objects, const std::vector<NamedPoint>& landmarks);

/// A landmark, and the motion that a plan carries it by; the identity where it stays.
struct MovedLandmark {
  NamedPoint landmark;  ///< as it lies in the scan
  glm::dmat4 moved_from_still{1.0};
};

/// Where a plan's objects take the landmarks. A landmark goes with the piece whose bone is nearest to it; it
/// stays where other bone is nearer, or nothing that moves lies within 3 mm: surgeons place landmarks to
/// about that. On a cut it goes with the piece. Of pieces that are moved again the last motion counts. Cost:
/// some small Booleans a landmark and moved object.
std::vector<MovedLandmark> moved_landmarks(const Objects& objects, const std::vector<NamedPoint>& landmarks);

}  // namespace octotomy::planner
