// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>

// Movements in anatomical words. The columns of `lps_from_head` are the head's directions left, back and up
// as unit vectors in LPS. With the identity, these are the axes of the scan.
namespace octotomy::planner {

/// A displacement in mm along the head's directions. Negative numbers are back, right and down.
struct Displacement {
  double forward_mm = 0.0;
  double left_mm = 0.0;
  double up_mm = 0.0;
};
/// A rotation as three turns about the head's fixed directions, roll first, then pitch, then yaw. Pitch is
/// positive where the front goes up, yaw where the front goes to the patient's left, roll where the patient's
/// left goes up.
struct Turns {
  double pitch_deg = 0.0;
  double yaw_deg = 0.0;
  double roll_deg = 0.0;
};

glm::dvec3 lps_mm(const Displacement& displacement, const glm::dmat3& lps_from_head);
Displacement displacement_of(const glm::dvec3& lps_mm, const glm::dmat3& lps_from_head);

/// The rotation matrix of the turns, from LPS to LPS.
glm::dmat3 rotation_of(const Turns& turns, const glm::dmat3& lps_from_head);
/// The turns of a rotation, the inverse of rotation_of(). Pitch lies between -90 and 90 degrees. At a pitch
/// of 90 or -90 degrees yaw and roll are not separate: roll is 0.
Turns turns_of(const glm::dmat3& rotation, const glm::dmat3& lps_from_head);

/// Text such as "forward 6.0 mm, down 1.9 mm, left 0.3 mm"; "no movement" if each part is below 0.05 mm.
std::string in_words(const Displacement& displacement);
/// Text such as "pitch 5.0° (front up), yaw 0.3° (front to the left), roll 0.0°".
std::string in_words(const Turns& turns);

/// The meaning of the words and signs of in_words(), for reports.
inline constexpr const char* movement_words =
    "Forward, left and up are the directions of the patient's head: its axes after head_position, otherwise "
    "the scan's. Pitch is positive where the front goes up, yaw where the front goes to the patient's left, "
    "roll where the patient's left side goes up; roll is "
    "done first, then pitch, then yaw.";

}  // namespace octotomy::planner
