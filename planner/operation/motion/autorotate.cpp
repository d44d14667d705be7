// SPDX-License-Identifier: AGPL-3.0-or-later
// Rotates the mandible about its condyles until first contact. The angle is determined first, on voxels, so
// that both kernels use the same angle.
#include <algorithm>
#include <array>
#include <cmath>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/motion/first_contact.h"
#include "planner/operation/motion/move.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"
#include "voxel/measure/measure.h"

namespace octotomy::planner {
namespace {

struct Autorotate {
  ObjectName object, against;
  std::vector<Mark> condyles;
  double most_deg = 15.0;
  // The following members are determined before the kernels run.
  double closed_deg = 0.0;
  glm::dmat4 moved_from_still{1.0};
  std::optional<glm::dvec3> contact_mm;
};

/// The rotation about the axis from the left condyle to the right one. A positive angle is right-handed about
/// this axis and moves the front of the mandible upwards.
glm::dmat4 turn(const std::array<glm::dvec3, 2>& right_left_mm, double degrees) {
  voxel::Motion motion;
  motion.degrees = degrees;
  motion.axis = right_left_mm[0] - right_left_mm[1];
  motion.about_mm = right_left_mm[0];
  return voxel::moved_from_still(motion);
}

/// The greatest distance of a box's corners from the axis, in mm.
double reach_mm(const voxel::Box& box, const std::array<glm::dvec3, 2>& axis_mm) {
  const glm::dvec3 along = glm::normalize(axis_mm[1] - axis_mm[0]);
  double reach = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? box.high_mm.x : box.low_mm.x, corner & 2 ? box.high_mm.y : box.low_mm.y,
                       corner & 4 ? box.high_mm.z : box.low_mm.z);
    reach = std::max(reach, glm::length(glm::cross(p - axis_mm[0], along)));
  }
  return reach;
}

void check(const Autorotate& asked, const FieldLocation& place) {
  if (asked.object.name == asked.against.name)
    place.at("against").refuse("is the object itself: name the object that it is rotated against");
  const std::vector<Mark>& condyles = asked.condyles;
  if (condyles[0].object.empty() && condyles[1].object.empty() &&
      glm::distance(condyles[0].p_mm, condyles[1].p_mm) < 10.0)
    place.at("condyles").refuse("lie within 10 mm of each other: state the right condyle, then the left one");
}

Autorotate settle(const Autorotate& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "autorotate");
  const Object& object = bench.objects.at(asked.object.name);
  const std::array<glm::dvec3, 2> axis_mm{mark_mm(asked.condyles[0], bench.objects),
                                          mark_mm(asked.condyles[1], bench.objects)};
  const auto extents = voxel::measure(object.voxel.octree).extents;
  const double farthest_mm =
      extents ? reach_mm({extents->low_mm, extents->high_mm}, axis_mm) : voxel_mm(object);
  const FirstContact found =
      first_contact(object, bench.objects.at(asked.against.name),
                    {[&](double degrees) { return turn(axis_mm, degrees); },
                     glm::degrees(0.5 * voxel_mm(object) / farthest_mm), asked.most_deg,
                     plain(asked.most_deg) + "\u00b0: check the condyles, or raise 'most_deg'"},
                    bench.progress.stop);
  Autorotate settled = asked;
  settled.closed_deg = found.apart;
  settled.moved_from_still = turn(axis_mm, found.apart);
  settled.contact_mm = found.contact_mm;
  return settled;
}

std::string definition(const Autorotate& asked, const Objects&) {
  return asked.object.name + (asked.closed_deg < 0.0 ? " opened by " : " closed by ") +
         plain(std::round(100.0 * std::abs(asked.closed_deg)) / 100.0) + "\u00b0 to first contact with " +
         asked.against.name;
}

void bound(const Autorotate& asked, const BoundBench& bench, Object& made) {
  move_bound(asked, bench, made);
  made.moved->details = {{"closed_deg", asked.closed_deg}, {"contact_mm", to_json(asked.contact_mm)}};
}

}  // namespace

Operation autorotate_operation() {
  return Describe<Autorotate>(
             "autorotate", "Rotates the mandible about its condyles until it first touches another object.",
             Makes::Object)
      .takes(field("object", &Autorotate::object, "The mandible, or its part.").required())
      .takes(field("against", &Autorotate::against, "The object to meet.").required())
      .takes(field("condyles", &Autorotate::condyles,
                   "The centres of the right and of the left condyle: [x, y, z] or landmarks.")
                 .required()
                 .from(2)
                 .to(2))
      .takes(field("most_deg", &Autorotate::most_deg,
                   "The largest rotation that is tried. It closes the mandible, or opens it if the objects "
                   "overlap at first.")
                 .greater_than(0.0)
                 .to(60.0))
      .example(R"({"id": "closed", "do": "autorotate", "object": "rest", "against": "advanced",
        "condyles": [[-50, -5, -15], [50, -5, -15]]})")
      .motion()
      .check(check)
      .settle(settle)
      .object(definition, moved_voxels<Autorotate>, moved_triangles<Autorotate>, bound);
}

}  // namespace octotomy::planner
