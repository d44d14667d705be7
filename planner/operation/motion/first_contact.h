// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// The distance that an object travels along a motion of one parameter until it touches another object.
struct FirstContact {
  double apart = 0.0;  ///< the last parameter without contact; below zero where they overlap at zero
  std::optional<glm::dvec3> contact_mm;  ///< the centre of the first contact
};

struct ContactSearch {
  std::function<glm::dmat4(double)> motion;  ///< LPS to LPS; the identity at zero
  double step = 0.0;                         ///< a step of the parameter; it moves no point of the object by
                                             ///< more than half a voxel
  double most = 0.0;                         ///< the largest parameter that is tried
  std::string most_said;                     ///< text of `most` for refusals: "15°: raise 'most_deg'"
};

/// Finds the first contact in voxels. Steps forward until the objects touch, so that no contact is skipped,
/// or backward until an overlap ends; then bisects the last step down to 1/64 of it. Throws
/// std::runtime_error where either object is empty or no contact is found; Stopped. Cost: one Boolean per
/// step.
FirstContact first_contact(const Object& object, const Object& against, const ContactSearch& search,
                           const std::stop_token& stop);

/// The shortest edge of an object's voxels.
double voxel_mm(const Object& object);

}  // namespace octotomy::planner
