// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "brep/measure/docking_contacts.h"
#include "brep/mesh/progress.h"

namespace octotomy::brep {

/// A small motion that contacts resist too little: a turn about an axis, or a slide along a direction.
struct Loosening {
  bool turns = false;
  glm::dvec3 direction{0.0};  ///< unit, LPS: of the axis, right-handed, or of the slide
  glm::dvec3 about_mm{0.0};   ///< of a turn: the axis's point nearest to the contacts' middle
};

/// How firmly contacts hold a part that is pushed at a point.
struct Docking {
  /// The push is held as long as it deviates by less than this from its direction, to any side; 0 to
  /// `most_docking_deg`.
  double angle_deg = 0.0;
  glm::dvec3 at_mm{0.0};               ///< the point that is pushed
  std::optional<Loosening> loosening;  ///< the motion that begins at that angle; none if the largest angle is
                                       ///< held
};

/// The largest deviation of a push that is examined.
constexpr double most_docking_deg = 89.0;
/// The limit for the sum of all reactions, as a multiple of the push's component along its nominal direction.
/// With larger reactions, a part would wedge itself between walls along the push, and the smallest error of
/// the walls' normals would release it. For motions this means: contacts resist too little if the pushed
/// point moves by more than ten times the depth by which the contacts would have to give way.
constexpr double most_reaction = 10.0;

/// The docking angle at each of the pushed points. Contacts push along their normals, without friction. A
/// push is held if reactions that are not negative and within `most_reaction` balance its force and its
/// moment. The angle at a point is half the opening of the widest circular cone about `push` in which all
/// pushes are held. Larger angles than `at_most_deg` are reported as that angle, in less time. `push` is a
/// unit vector, LPS. Throws std::invalid_argument if it is not, if there are no contacts or no points, or if
/// `at_most_deg` is beyond 0..`most_docking_deg`; Error (Geometry) if rounding hides the answer; Stopped. The
/// same bits on any number of threads. Cost: for each point about two linear programmes of seven rows for
/// each side of the set of held pushes; parallel. Source: Mattheijer and others, docking robustness of
/// patient specific surgical guides. Departures: reactions are limited, and all sides of the set of held
/// pushes are found, not samples.
std::vector<Docking> dockings(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                              const std::vector<glm::dvec3>& points_mm, const Progress& progress = {},
                              double at_most_deg = most_docking_deg);

/// dockings() at the corners of the points' convex hull, the smallest angle first. The points at which one
/// push is held form a convex set, so the smallest angle of all points is at a corner.
std::vector<Docking> worst_dockings(const std::vector<DockingContact>& contacts, const glm::dvec3& push,
                                    const std::vector<glm::dvec3>& points_mm, const Progress& progress = {});

}  // namespace octotomy::brep
