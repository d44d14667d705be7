// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "planner/operation/table/object.h"
#include "planner/operation/table/scope.h"

namespace octotomy::planner {

struct ObjectMovement;

/// The point after a motion.
inline glm::dvec3 carried(const glm::dmat4& motion, const glm::dvec3& p_mm) {
  return glm::dvec3(motion * glm::dvec4(p_mm, 1.0));
}

/// The last motion of each moved object, in the order of the objects: the motion, its rotations, and the
/// displacements of the object's centroid and landmarks, in words and along the head's directions. A map that
/// scales or shears has the rotations of the nearest rotation, and words for the rest. Where earlier steps
/// moved the object as well, also the displacements since the scan. Landmarks move with objects by the rules
/// of moved_landmarks(). Cost: some small Booleans per landmark and object.
std::vector<ObjectMovement> movements_of(const Objects& objects, const std::vector<NamedPoint>& landmarks);
/// The movements as JSON, with the details that the moving steps have reported.
nlohmann::ordered_json movements_json(const Objects& objects, const std::vector<NamedPoint>& landmarks);

/// A landmark and its motion by the plan; the identity where it does not move.
struct MovedLandmark {
  NamedPoint landmark;  ///< its position in the scan
  glm::dmat4 moved_from_still{1.0};
  bool is_predicted = false;  ///< it lies on the skin, and a step or a file states its motion
  /// The motion errs by this vector times a normally distributed number: the deviation of a ratio times the bone's
  /// motion.
  glm::dvec3 deviation_mm{0.0};
};

/// The motions of landmarks with a plan's objects. A landmark moves with a piece within 3 mm of it unless
/// bone that stays is nearer; 3 mm is about the error of landmarks placed by surgeons. A landmark on a cut
/// moves with the piece. Of several such pieces, or motions of one piece, the last counts. The last
/// landmark_ratios step that names a landmark of the skin states its motion. Cost: some small Booleans per
/// landmark and moved object.
std::vector<MovedLandmark> moved_landmarks(const Objects& objects, const std::vector<NamedPoint>& landmarks);

}  // namespace octotomy::planner
