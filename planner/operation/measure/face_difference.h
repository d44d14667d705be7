// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "planner/operation/measure/measured_ratios.h"
#include "planner/operation/table/object.h"

namespace octotomy::planner {

/// Two predictions of the same skin, compared point by point: at the landmarks of those that moved by ratios, and over
/// the skin that nothing hides from the front, within their reach. A landmark has the displacement of the nearest point
/// of the skin. None unless both objects displace the points of one object and at least one has landmarks with ratios.
/// Cost: triangles of the skin times its landmarks.
std::optional<FaceDifference> face_difference(const Object& a, const Object& b, const Objects& objects);

}  // namespace octotomy::planner
