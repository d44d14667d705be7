// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planner/operation/table/record.h"

// Movements of a plan's objects: the records below `movements` in a result.
namespace octotomy::planner {

/// A displacement in mm along the head's directions, and the same in words.
struct MeasuredDisplacement {
  double forward_mm = 0.0, left_mm = 0.0, up_mm = 0.0;
  std::string words;
};
constexpr auto members_of(const MeasuredDisplacement&) {
  using D = MeasuredDisplacement;
  return std::tuple(member("forward_mm", &D::forward_mm), member("left_mm", &D::left_mm),
                    member("up_mm", &D::up_mm), member("words", &D::words));
}

/// The displacement of a landmark by the last motion of the object on which it lies; `to_mm` is its position
/// afterwards, LPS.
struct LandmarkMovement {
  std::string name;
  double forward_mm = 0.0, left_mm = 0.0, up_mm = 0.0;
  std::string words;
  glm::dvec3 to_mm{0.0};
  std::optional<MeasuredDisplacement> since_scan;  ///< from the scan's position; none unless earlier steps
                                                   ///< moved the object, too
};
constexpr auto members_of(const LandmarkMovement&) {
  using L = LandmarkMovement;
  return std::tuple(member("name", &L::name), member("forward_mm", &L::forward_mm),
                    member("left_mm", &L::left_mm), member("up_mm", &L::up_mm), member("words", &L::words),
                    member("to_mm", &L::to_mm), member_if_any("since_scan", &L::since_scan));
}

/// A point of a piece with a prescribed target: the displacement that was achieved and the distance that
/// remains.
struct PointMovement {
  std::string name;
  std::string wanted, achieved;  ///< in words
  double forward_mm = 0.0, left_mm = 0.0, up_mm = 0.0;
  double residual_mm = 0.0;  ///< distance of the moved point from its target
};
constexpr auto members_of(const PointMovement&) {
  using P = PointMovement;
  return std::tuple(member("name", &P::name), member("wanted", &P::wanted), member("achieved", &P::achieved),
                    member("forward_mm", &P::forward_mm), member("left_mm", &P::left_mm),
                    member("up_mm", &P::up_mm), member("residual_mm", &P::residual_mm));
}

/// The last motion of an object: `from` is the object before it.
struct ObjectMovement {
  std::string object, from;
  double pitch_deg = 0.0, yaw_deg = 0.0, roll_deg = 0.0;
  std::string words;
  std::optional<MeasuredDisplacement> centroid;  ///< none for an empty object
  std::vector<LandmarkMovement> landmarks;
  std::vector<PointMovement> points;  ///< only for a motion that was stated by points
};
constexpr auto members_of(const ObjectMovement&) {
  using M = ObjectMovement;
  return std::tuple(member("object", &M::object), member("from", &M::from),
                    member("pitch_deg", &M::pitch_deg), member("yaw_deg", &M::yaw_deg),
                    member("roll_deg", &M::roll_deg), member("words", &M::words),
                    member("centroid", &M::centroid), member("landmarks", &M::landmarks),
                    member_if_any("points", &M::points));
}

}  // namespace octotomy::planner
