// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/anatomy/head_directions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>
#include <vector>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner {
namespace {

/// The head's axes forward, left and up as columns. They are right-handed, so the usual matrices of roll,
/// pitch and yaw apply.
glm::dmat3 lps_from_forward(const glm::dmat3& lps_from_head) {
  return {-lps_from_head[1], lps_from_head[0], lps_from_head[2]};
}

glm::dmat3 about(int axis, double degrees) {
  glm::dvec3 direction(0.0);
  direction[axis] = 1.0;
  return glm::dmat3(glm::rotate(glm::dmat4(1.0), glm::radians(degrees), direction));
}

}  // namespace

glm::dvec3 lps_mm(const Displacement& displacement, const glm::dmat3& lps_from_head) {
  return lps_from_forward(lps_from_head) *
         glm::dvec3(displacement.forward_mm, displacement.left_mm, displacement.up_mm);
}

Displacement displacement_of(const glm::dvec3& lps_mm, const glm::dmat3& lps_from_head) {
  const glm::dvec3 along = glm::transpose(lps_from_forward(lps_from_head)) * lps_mm;
  return {along.x + 0.0, along.y + 0.0, along.z + 0.0};  // no negative zeros
}

glm::dmat3 rotation_of(const Turns& turns, const glm::dmat3& lps_from_head) {
  const glm::dmat3 frame = lps_from_forward(lps_from_head);
  return frame * about(2, turns.yaw_deg) * about(1, -turns.pitch_deg) * about(0, turns.roll_deg) *
         glm::transpose(frame);
}

Turns turns_of(const glm::dmat3& rotation, const glm::dmat3& lps_from_head) {
  const glm::dmat3 frame = lps_from_forward(lps_from_head);
  const glm::dmat3 r = glm::transpose(frame) * rotation * frame;  // r[column][row]
  const double sine = std::clamp(r[0][2], -1.0, 1.0);
  Turns turns;
  turns.pitch_deg = glm::degrees(std::asin(sine));
  if (std::hypot(r[0][0], r[0][1]) < 1e-9) {
    turns.yaw_deg = glm::degrees(std::atan2(-r[1][0], r[1][1]));
  } else {
    turns.yaw_deg = glm::degrees(std::atan2(r[0][1], r[0][0]));
    turns.roll_deg = glm::degrees(std::atan2(r[1][2], r[2][2]));
  }
  return {turns.pitch_deg + 0.0, turns.yaw_deg + 0.0, turns.roll_deg + 0.0};
}

std::string in_words(const Displacement& displacement) {
  std::string text;
  const auto say = [&](double mm, const char* positive, const char* negative) {
    if (std::abs(mm) < 0.05) return;
    text += (text.empty() ? "" : ", ") + std::string(mm > 0.0 ? positive : negative) + " " +
            grouped(std::abs(mm), 1) + " mm";
  };
  say(displacement.forward_mm, "forward", "back");
  say(displacement.up_mm, "up", "down");
  say(displacement.left_mm, "left", "right");
  return text.empty() ? "no movement" : text;
}

std::string in_words(const Turns& turns) {
  const auto say = [](const char* name, double degrees, const char* positive, const char* negative) {
    const bool is_zero = std::abs(degrees) < 0.05;
    return std::string(name) + " " + grouped(is_zero ? 0.0 : degrees, 1) + "\u00b0" +
           (is_zero ? "" : std::string(" (") + (degrees > 0.0 ? positive : negative) + ")");
  };
  return say("pitch", turns.pitch_deg, "front up", "front down") + ", " +
         say("yaw", turns.yaw_deg, "front to the left", "front to the right") + ", " +
         say("roll", turns.roll_deg, "left side up", "left side down");
}

}  // namespace octotomy::planner
