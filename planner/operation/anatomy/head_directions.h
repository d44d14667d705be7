// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>

// Movements in anatomical words. A head's directions are the columns of `lps_from_head`: its left, back and
// up as unit vectors of LPS; the identity is the head's position in the scan.
namespace octotomy::planner {

/// A displacement along the head's directions; negative: back, right, down.
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

/// The rotation, LPS to LPS.
glm::dmat3 rotation_of(const Turns& turns, const glm::dmat3& lps_from_head);
/// The inverse of rotation_of(), pitch from -90 to 90. At a pitch of 90 degrees yaw takes the whole turn and
/// roll is 0.
Turns turns_of(const glm::dmat3& rotation, const glm::dmat3& lps_from_head);

/// "forward 6.0 mm, down 1.9 mm, left 0.3 mm"; "no movement" below a twentieth of a millimetre each.
std::string in_words(const Displacement& displacement);
/// "pitch 5.0° (front up), yaw 0.3° (front to the left), roll 0.0°".
std::string in_words(const Turns& turns);

/// What the words and signs mean, for reports.
inline constexpr const char* movement_words =
    "Forward, left and up are the patient's own, as the head is held. Pitch is positive where the front goes "
    "up, yaw where the front goes to the patient's left, roll where the patient's left side goes up; roll is "
    "done first, then pitch, then yaw.";

}  // namespace octotomy::planner
