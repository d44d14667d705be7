// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves a piece in one direction until it touches another one, or until a gap remains. The distance is
// determined first, on voxels, so that both kernels use the same distance.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/motion/first_contact.h"
#include "planner/operation/motion/move.h"
#include "planner/operation/table/number_format.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct Advance {
  ObjectName object, against;
  std::optional<std::string> towards;
  std::optional<glm::dvec3> direction;
  double gap_mm = 0.0, most_mm = 30.0;
  // The following members are determined before the kernels run.
  double contact_after_mm = 0.0;
  glm::dmat4 moved_from_still{1.0};
  std::optional<glm::dvec3> contact_mm;
};

void check(const Advance& asked, const FieldLocation& place) {
  if (asked.object.name == asked.against.name)
    place.at("against").refuse("is the object itself: name the object that it is moved against");
  if (asked.towards.has_value() == asked.direction.has_value())
    place.refuse("needs either 'towards', a word, or 'direction', a vector, but not both");
  if (asked.direction && !(glm::length(*asked.direction) > 0.0))
    place.at("direction")
        .refuse("has no length: state the direction of the movement, for example [0, -1, 0]");
}

/// The direction of the movement as a unit vector, LPS.
glm::dvec3 direction_of(const Advance& asked, const glm::dmat3& lps_from_head) {
  if (asked.direction) return glm::normalize(*asked.direction);
  const std::string& word = *asked.towards;
  const double sign = word == "back" || word == "right" || word == "down" ? -1.0 : 1.0;
  Displacement by;
  (word == "forward" || word == "back" ? by.forward_mm
   : word == "left" || word == "right" ? by.left_mm
                                       : by.up_mm) = sign;
  return lps_mm(by, lps_from_head);
}

Advance settle(const Advance& asked, const SettleBench& bench) {
  const Stopwatch watch(bench.timings, "advance");
  const Object& object = bench.objects.at(asked.object.name);
  const glm::dvec3 direction = direction_of(asked, bench.objects.lps_from_head);
  const auto motion = [&](double mm) { return glm::translate(glm::dmat4(1.0), mm * direction); };
  const FirstContact found =
      first_contact(object, bench.objects.at(asked.against.name),
                    {motion, 0.5 * voxel_mm(object), asked.most_mm,
                     plain(asked.most_mm) + " mm: check the direction, or raise 'most_mm'"},
                    bench.progress.stop);
  Advance settled = asked;
  settled.contact_after_mm = found.apart;
  settled.moved_from_still = motion(found.apart - asked.gap_mm);
  settled.contact_mm = found.contact_mm;
  return settled;
}

std::string definition(const Advance& asked, const Objects&) {
  return asked.object.name + " moved " +
         plain(std::round(100.0 * (asked.contact_after_mm - asked.gap_mm)) / 100.0) + " mm " +
         (asked.gap_mm > 0.0 ? "to " + plain(asked.gap_mm) + " mm before" : "to") + " first contact with " +
         asked.against.name;
}

void bound(const Advance& asked, const BoundBench& bench, Object& made) {
  move_bound(asked, bench, made);
  made.moved->details = {{"contact_after_mm", asked.contact_after_mm},
                         {"contact_mm", to_json(asked.contact_mm)}};
}

}  // namespace

Operation advance_operation() {
  return Describe<Advance>("advance", "Moves an object in one direction until it touches another object.",
                           Makes::Object)
      .takes(field("object", &Advance::object, "The object, or its part.").required())
      .takes(field("against", &Advance::against, "The object to meet.").required())
      .takes(field("towards", &Advance::towards,
                   "The direction of the movement, relative to the head's position.")
                 .one_of({"forward", "back", "left", "right", "up", "down"}))
      .takes(field("direction", &Advance::direction,
                   "The direction of the movement as an LPS vector of any length, instead of 'towards'."))
      .takes(
          field("gap_mm", &Advance::gap_mm, "The distance to the other object at which the movement stops.")
              .from(0.0)
              .to(100.0))
      .takes(
          field("most_mm", &Advance::most_mm,
                "The largest movement that is tried. If the objects overlap at first, the object moves back.")
              .greater_than(0.0)
              .to(500.0))
      .example(R"({"id": "met", "do": "advance", "object": "maxilla", "against": "rest",
        "towards": "back", "gap_mm": 0.5})")
      .motion()
      .of_head()
      .check(check)
      .settle(settle)
      .object(definition, moved_voxels<Advance>, moved_triangles<Advance>, bound);
}

}  // namespace octotomy::planner
