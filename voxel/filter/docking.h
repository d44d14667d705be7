// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/filter/docking_contacts.h"

namespace octotomy::voxel {

/// How firmly contacts hold a part that is pushed at a point.
struct Docking {
  /// The push may deviate by less than this from its direction, whatever the side; 0 to `most_docking_deg`.
  double angle_deg = 0.0;
  glm::dvec3 at_mm{0.0};  ///< the point that is pushed, LPS
};

/// Pushes that deviate by more are not looked at.
constexpr double most_docking_deg = 89.0;
/// The largest sum of all reactions, over the push's component along its nominal direction: walls along the
/// push do not wedge a part in.
constexpr double most_reaction = 10.0;

/// The docking angle at the worst of the pushed points. Contacts push along their normals, without friction.
/// A push is held if its force and its moment are balanced by reactions that are not negative and within
/// `most_reaction`. The angle at a point is half the opening of the widest circular cone about `push` of
/// which all pushes are held; it is at most 0.1 % too large. For one push, the points where it is held form a
/// convex set; so only points that lie farthest in one of about 160 directions are examined. `push` is a unit
/// vector, LPS. Throws std::invalid_argument if it is not, or without contacts or points; Stopped. The same
/// bits on any number of threads. Cost: some hundred searches of nearest points of the contacts' cone for
/// each examined point; parallel. Source: Mattheijer and others, docking robustness of patient specific
/// surgical guides.
Docking docking(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                const std::vector<glm::dvec3>& points_mm, const Progress& progress = {});

}  // namespace octotomy::voxel
