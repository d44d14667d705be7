// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brep/measure/docking.h"

namespace octotomy::planner {

/// Why two sets of contacts of one part hold it by different docking angles.
struct DockingDispute {
  bool first_holds = false;  ///< the larger angle is that of the first set
  glm::dvec3 at_mm{0.0};     ///< the contact of the stronger set that the weaker one lacks most, LPS
  /// Between its normal and the most similar one of the weaker set nearby; none if the weaker set has no
  /// contact there.
  std::optional<double> normals_deg;
  int places = 0;              ///< the number of such contacts that were added, each with its neighbours
  double explained_deg = 0.0;  ///< the weaker set's docking angle with them
};

struct DockingDisputeOptions {
  double near_mm = 2.0;    ///< a contact within this distance is another one of the same bone
  double patch_mm = 4.0;   ///< contacts within this distance are added together
  double close_deg = 1.0;  ///< angles are alike within this
};

/// Finds the contacts that make the difference. The weaker set gives way by a motion. The contact of the
/// stronger set that resists this motion most, and its neighbours, are added to the weaker set, again and
/// again, until the angles are alike or eight places are added. All lengths in mm, LPS. None if no contact of
/// the stronger set resists. Throws as worst_dockings(). Cost: at most nine of those.
std::optional<DockingDispute> dispute(const std::vector<brep::DockingContact>& first,
                                      const std::vector<brep::DockingContact>& second, const glm::dvec3& push,
                                      const std::vector<glm::dvec3>& points_mm,
                                      const DockingDisputeOptions& options);

}  // namespace octotomy::planner
