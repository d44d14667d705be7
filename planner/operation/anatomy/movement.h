// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "planner/operation/table/object.h"
#include "planner/operation/table/scope.h"

namespace octotomy::planner {

struct ObjectMovement;

/// The position of a point after a motion, LPS millimetres.
inline glm::dvec3 carried(const glm::dmat4& motion, const glm::dvec3& p_mm) {
  return glm::dvec3(motion * glm::dvec4(p_mm, 1.0));
}

/// The last motion of each moved object, in the order of the objects: its rotation, and the displacements of
/// the object's centroid and landmarks, in words and along the head's directions. For a map that scales or
/// shears, the angles are those of the nearest rotation, and the words describe the scaling. If earlier steps
/// moved the object, too, a landmark also has its displacement since the scan. Landmarks move with objects as
/// moved_landmarks() describes. Cost: a few small Booleans per landmark and object.
std::vector<ObjectMovement> movements_of(const Objects& objects, const std::vector<NamedPoint>& landmarks);
/// The movements as JSON, with the details that the moving steps reported.
nlohmann::ordered_json movements_json(const Objects& objects, const std::vector<NamedPoint>& landmarks);

/// A landmark and its motion by the plan, the identity if it does not move.
struct MovedLandmark {
  NamedPoint landmark;  ///< at its position in the scan
  glm::dmat4 moved_from_still{1.0};
  bool is_predicted = false;  ///< true if it lies on the skin and a landmark_ratios step or a file states its
                              ///< motion
  /// Standard deviation of the predicted motion, as a vector along the bone's motion: the ratio's deviation
  /// times that motion.
  glm::dvec3 deviation_mm{0.0};
};

/// The motions of landmarks by a plan. A landmark moves with a piece within 3 mm of it unless bone that stays
/// is nearer; 3 mm is about the error of landmarks placed by surgeons. A landmark on a cut moves with the
/// piece. If several pieces or several motions of a piece apply, the last one counts. A landmark of the skin
/// moves as the last landmark_ratios step that names it states. Cost: a few small Booleans per landmark and
/// moved object.
std::vector<MovedLandmark> moved_landmarks(const Objects& objects, const std::vector<NamedPoint>& landmarks);

}  // namespace octotomy::planner
