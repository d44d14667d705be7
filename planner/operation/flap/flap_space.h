// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/scope.h"

// Facts about the step that made the space of a free flap, for guides, screws and motions.
namespace octotomy::planner {

class Action;

/// A cut at an end of a flap's space, LPS. Points p of the cut: dot(away, p - point_mm) = 0.
struct FlapCut {
  glm::dvec3 point_mm{0.0};      ///< on the axis of the flap or donor
  glm::dvec3 away{0, 0, 1};      ///< unit: towards the side of the saw's kerf
  double kerf_mm = 1.0;          ///< the saw's width
  double reach_mm = 12.0;        ///< the cut extends this far from point_mm
  bool is_of_resection = false;  ///< the cut is at an end of the resection, not of a segment
};
/// The cuts at both ends of a segment's space, or of the resection's. A segment's kerf lies outside the
/// segment, the resection's kerf inside the resection. Empty if the step made no such space.
std::vector<FlapCut> flap_cuts(const Action& maker);

/// A place on the axis of a flap, with the motion from a placed segment to its place on the uncut bone.
struct FlapPlace {
  glm::dvec3 on_axis_mm{0.0};  ///< in the placed segment, LPS
  glm::dvec3 along{0, 0, 1};   ///< unit: the axis there
  double reach_mm = 12.0;      ///< the bone's surface is at most this far from the axis
  /// LPS to LPS, rigid; none if the space is that of the placed segment, or of bone that stays.
  std::optional<glm::dmat4> uncut_from_placed;
};
/// The place at a share of the way from the first cut (0) to the second cut (1) of a segment's space. For the
/// resection's space the place lies in the bone that stays: from -1 at the first point of the stumps to 0 at
/// the first cut, or from 1 at the last cut to 2 at the last point of the stumps. Throws std::runtime_error
/// that states the value for another share, and also for a resection without stumps or a step that made no
/// such space. `name` is the step's name for the message.
FlapPlace flap_place(const Action* maker, const std::string& name, double share);

}  // namespace octotomy::planner
