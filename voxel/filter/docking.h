// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/filter/docking_contacts.h"

namespace octotomy::voxel {

/// The directions in which contacts hold a part against a push at one point.
struct Docking {
  /// The part is held if the push deviates by less than this angle from its nominal direction, to any side; 0
  /// to `most_docking_deg`.
  double angle_deg = 0.0;
  glm::dvec3 at_mm{0.0};  ///< the point that is pushed, LPS
};

/// Pushes that deviate by a larger angle from the nominal direction are not examined.
constexpr double most_docking_deg = 89.0;
/// The largest allowed sum of all reactions, divided by the push's component along its nominal direction.
/// Without this limit, walls parallel to the push could hold a part by wedging it.
constexpr double most_reaction = 10.0;

/// Computes the docking angle for the pushed point at which it is smallest. Contacts push along their
/// normals, without friction. A push is held if its force and its moment are balanced by reactions that are
/// not negative and within `most_reaction`. The angle at a point is half the opening of the widest circular
/// cone about `push` in which all pushes are held. The computed angle is at most 0.1 % too large. The points
/// at which a given push is held form a convex set, so only points that lie farthest in one of about 160
/// directions are examined. `push` is a unit vector, LPS. Throws std::invalid_argument if it is not, or if
/// there are no contacts or no points; Stopped. Parallel; the same bits on any number of threads. Cost: for
/// each examined point, some hundred searches for the nearest point of the contacts' cone. Source: Mattheijer
/// and others, docking robustness of patient specific surgical guides.
Docking docking(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                const std::vector<glm::dvec3>& points_mm, const Progress& progress = {});

}  // namespace octotomy::voxel
