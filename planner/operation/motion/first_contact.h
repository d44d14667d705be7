// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>

#include "planner/operation/table/bench.h"

namespace octotomy::planner {

/// The first contact of an object that moves along a motion with one parameter, such as a distance or an
/// angle.
struct FirstContact {
  double apart = 0.0;  ///< the last parameter without contact; negative if the objects overlap at zero
  std::optional<glm::dvec3> contact_mm;  ///< the centre of the first contact
};

struct ContactSearch {
  std::function<glm::dmat4(double)> motion;  ///< the motion for a parameter, LPS to LPS; the identity at zero
  double step = 0.0;                         ///< step of the parameter; a step must move no point of the
                                             ///< object by more than half a voxel
  double most = 0.0;                         ///< the largest parameter that is tried
  std::string most_said;                     ///< text of `most` for refusals: "15°: raise 'most_deg'"
};

/// Finds the first contact in voxels. Steps forward until the objects touch, or backward until an overlap
/// ends; small steps skip no contact. Then bisects the last step down to 1/64. Throws std::runtime_error if
/// either object is empty or no contact is found; Stopped. Cost: one Boolean per step.
FirstContact first_contact(const Object& object, const Object& against, const ContactSearch& search,
                           const std::stop_token& stop);

/// The shortest edge of an object's voxels.
double voxel_mm(const Object& object);

}  // namespace octotomy::planner
