// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/operation/flap/design.h"
#include "planner/operation/table/field.h"
#include "planner/operation/table/scope.h"

namespace octotomy::planner {

/// The fields that all steps of one free flap share. Equal fields give equal cuts in every step.
struct FlapFields {
  std::vector<Mark> curve, stumps, donor;
  Mark face;
  glm::dvec3 facing{0, 0, -1};
  double roll_deg = 0.0;
  double start_mm = 0.0;
  double kerf_mm = 1.0;
  double reach_mm = 12.0;
};

FlapPlan plan_of(const FlapFields& fields);
/// The segments of the fields' plan. Throws as flap_segments().
std::vector<FlapSegment> segments_of(const FlapFields& fields);
/// Refuses fields that define no flap, and landmarks that move with an object.
void check_flap(const FlapFields& fields, const FieldLocation& place);

/// The descriptions of these fields for an operation whose value derives from FlapFields.
template <typename Owner>
std::vector<Field> flap_fields() {
  const auto of = []<typename Value>(Value FlapFields::*member) {
    return static_cast<Value Owner::*>(member);
  };
  return {
      field("curve", of(&FlapFields::curve),
            "Corners of the new bone's axis, one more than there are segments: [x, y, z] or landmarks.")
          .required()
          .from(2)
          .to(9),
      field("stumps", of(&FlapFields::stumps),
            "Two points on the bone that stays, one beyond each end of the flap. The end cuts then bisect "
            "the angles between flap and bone. Default: the end cuts are square to the flap.")
          .from(2)
          .to(2),
      field("donor", of(&FlapFields::donor),
            "Two points on the donor bone's axis, in its scan: the flap begins near the first.")
          .required()
          .from(2)
          .to(2),
      field("face", of(&FlapFields::face),
            "A point on a face of the donor bone, beside its axis. 'facing' turns this face.")
          .required(),
      field("facing", of(&FlapFields::facing), "The direction of the donor's face in the first segment, LPS.")
          .direction(),
      field("roll_deg", of(&FlapFields::roll_deg), "An additional rotation of all segments about their axes.")
          .from(-180)
          .to(180),
      field("start_mm", of(&FlapFields::start_mm),
            "The distance from the donor's first point to the first cut, along the axis.")
          .from(0)
          .to(500),
      field("kerf_mm", of(&FlapFields::kerf_mm), "The width of a saw cut on the donor.").from(0).to(5),
      field("reach_mm", of(&FlapFields::reach_mm),
            "The largest distance of the donor bone's surface from its axis. Bone farther away, such as a "
            "neighbouring bone, is left out.")
          .greater_than(0)
          .to(60)};
}

}  // namespace octotomy::planner
