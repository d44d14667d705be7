// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "planner/operation/measure/measured_ratios.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// Compares two predictions of the same skin point by point: at the landmarks of predictions by ratios, and
/// over the skin that is visible from the front within the landmarks' reach. A landmark has the displacement
/// of the skin's nearest point. None unless both objects displace the points of the same object and at least
/// one has landmarks with ratios. Cost: triangles of the skin times its landmarks.
std::optional<FaceDifference> face_difference(const Object& a, const Object& b, const Objects& objects);

}  // namespace octotomy::planner
