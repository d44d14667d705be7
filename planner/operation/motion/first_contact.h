// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// How far an object goes along a motion of one parameter until it meets another one.
struct FirstContact {
  double apart = 0.0;  ///< the last parameter without contact; below zero where they overlap at zero
  std::optional<glm::dvec3> contact_mm;  ///< the middle of what touches first
};

struct ContactSearch {
  std::function<glm::dmat4(double)> motion;  ///< LPS to LPS; the identity at zero
  double step = 0.0;                         ///< moves no point of the object by more than half a voxel
  double most = 0.0;                         ///< parameters beyond are not tried
  std::string most_said;                     ///< what `most` is, for refusals: "15°: raise 'most_deg'"
};

/// Marches to contact in steps, so that nothing is passed, or back out of it, then halves the last step to a
/// 64th. In voxels. Throws std::runtime_error where either is empty or nothing is met; Stopped. Cost: a
/// Boolean a step.
FirstContact first_contact(const Object& object, const Object& against, const ContactSearch& search,
                           const std::stop_token& stop);

/// The shortest edge of an object's voxels.
double voxel_mm(const Object& object);

}  // namespace octotomy::planner
