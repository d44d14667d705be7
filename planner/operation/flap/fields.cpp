// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/flap/fields.h"

#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::planner {

FlapPlan plan_of(const FlapFields& fields) {
  FlapPlan plan;
  for (const Mark& mark : fields.curve) plan.curve_mm.push_back(mark.p_mm);
  for (const Mark& mark : fields.stumps) plan.stumps_mm.push_back(mark.p_mm);
  plan.donor_from_mm = fields.donor.at(0).p_mm;
  plan.donor_to_mm = fields.donor.at(1).p_mm;
  plan.donor_face_mm = fields.face.p_mm;
  plan.facing = fields.facing;
  plan.roll_deg = fields.roll_deg;
  plan.start_mm = fields.start_mm;
  plan.kerf_mm = fields.kerf_mm;
  plan.reach_mm = fields.reach_mm;
  return plan;
}

std::vector<FlapSegment> segments_of(const FlapFields& fields) {
  return flap_segments(plan_of(fields));
}

void check_flap(const FlapFields& fields, const FieldLocation& place) {
  const auto need_still = [&](const char* name, const std::vector<Mark>& marks) {
    for (const Mark& mark : marks)
      if (!mark.object.empty())
        place.at(name).refuse("'" + mark.landmark + "@" + mark.object +
                              "' is a landmark that moves with an object: name one of the scan, because a "
                              "flap is planned in the scan");
  };
  need_still("curve", fields.curve);
  need_still("stumps", fields.stumps);
  need_still("donor", fields.donor);
  need_still("face", {fields.face});
  try {
    segments_of(fields);
  } catch (const voxel::InvalidInput& error) {
    place.refuse(error.what());
  }
}

}  // namespace octotomy::planner
