// SPDX-License-Identifier: AGPL-3.0-or-later
// The position of the head. It defines the directions of views, and of words such as "forward", for all later
// steps.
#include <cmath>

#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/table/operation.h"

namespace octotomy::planner {
namespace {

struct HeadPosition {
  std::vector<Mark> frankfort, midline;
  double pitch_deg = 0.0, yaw_deg = 0.0, roll_deg = 0.0;
};

/// The shortest side of a triangle of landmarks from which a plane is computed. Landmarks are placed to about
/// 1 mm, and an error of 1 mm over 10 mm tilts the plane by 6 degrees.
constexpr double shortest_mm = 10.0;

glm::dvec3 direction(const glm::dvec3& vector, const FieldLocation& place, const char* of) {
  if (glm::length(vector) < shortest_mm)
    place.refuse(std::string("its points lie within 10 mm of ") + of + ": choose points farther apart");
  return glm::normalize(vector);
}

/// The directions left, back and up of the Frankfort plane through both porions and one orbitale, or the
/// middle of both.
glm::dmat3 of_frankfort(const std::vector<Mark>& marks, const FieldLocation& place) {
  const glm::dvec3 right = marks[0].p_mm, left = marks[1].p_mm;
  const glm::dvec3 front = marks.size() == 3 ? marks[2].p_mm : 0.5 * (marks[2].p_mm + marks[3].p_mm);
  const glm::dvec3 to_left = direction(left - right, place, "each other");
  const glm::dvec3 to_front = front - 0.5 * (left + right);
  const glm::dvec3 forward = direction(to_front - glm::dot(to_front, to_left) * to_left, place,
                                       "one line, which does not determine a plane");
  if (to_left.x <= 0.0)
    place.refuse(
        "the second point lies to the patient's right of the first: state the right porion, the left porion, "
        "then one or both orbitales");
  return {to_left, -forward, glm::cross(forward, to_left)};
}

/// The frame rotated about its up axis until its mid-plane is parallel to the line of the points.
glm::dmat3 along_midline(const glm::dmat3& frame, const std::vector<Mark>& marks,
                         const FieldLocation& place) {
  // The sum of the vectors between all pairs of points, without their part along up. Longer vectors count for
  // more.
  const glm::dvec3 up = frame[2];
  glm::dvec3 back(0.0);
  for (std::size_t i = 0; i < marks.size(); ++i)
    for (std::size_t j = i + 1; j < marks.size(); ++j) {
      glm::dvec3 between = marks[j].p_mm - marks[i].p_mm;
      between -= glm::dot(between, up) * up;
      back += glm::dot(between, frame[1]) < 0.0 ? -between : between;
    }
  back = direction(back, place, "one vertical line, which does not determine the mid-plane");
  return {glm::cross(back, up), back, up};
}

void check(const HeadPosition& position, const FieldLocation& place) {
  for (const std::vector<Mark>* marks : {&position.frankfort, &position.midline})
    for (const Mark& mark : *marks)
      if (!mark.object.empty())
        place.refuse("'" + mark.landmark + "@" + mark.object +
                     "' moves with an object: name a landmark of the scan instead");
  glm::dmat3 frame(1.0);
  if (!position.frankfort.empty()) frame = of_frankfort(position.frankfort, place.at("frankfort"));
  if (!position.midline.empty()) frame = along_midline(frame, position.midline, place.at("midline"));
  const Turns held{position.pitch_deg, position.yaw_deg, position.roll_deg};
  // The fields state the head's rotation relative to the room. The frame must be rotated the other way.
  frame = frame * glm::transpose(rotation_of(held, glm::dmat3(1.0)));
  if (place.scope != nullptr) place.scope->hold_head(place.where, frame);
}

}  // namespace

Operation head_position_operation() {
  return Describe<HeadPosition>(
             "head_position",
             "Sets the head's position. Later views and words such as 'forward' refer to it.", Makes::Names)
      .takes(field("frankfort", &HeadPosition::frankfort,
                   "Points of the Frankfort plane, which becomes level: right porion, left porion, one or "
                   "both orbitales. Default: the head's position in the scan.")
                 .from(3)
                 .to(4))
      .takes(field("midline", &HeadPosition::midline,
                   "Two or more points of the mid-plane, such as nasion and basion; the plane becomes "
                   "upright, from front to back. Default: perpendicular to the line through the porions.")
                 .from(2))
      .takes(
          field("pitch_deg", &HeadPosition::pitch_deg, "The front is raised by this angle.").from(-90).to(90))
      .takes(field("yaw_deg", &HeadPosition::yaw_deg,
                   "The front is rotated to the patient's left by this angle.")
                 .from(-180)
                 .to(180))
      .takes(field("roll_deg", &HeadPosition::roll_deg, "The patient's left side is raised by this angle.")
                 .from(-180)
                 .to(180))
      .example(R"({"id": "held", "do": "head_position",
        "frankfort": [[-60, 0, 10], [60, 0, 10], [-32, -75, 8], [32, -75, 8]], "pitch_deg": 4.5})")
      .check(check);
}

}  // namespace octotomy::planner
