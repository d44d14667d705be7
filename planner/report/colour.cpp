// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/report/colour.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

namespace octotomy::planner {

std::optional<glm::vec3> colour_of_text(const std::string& text) {
  if (text.size() != 7 || text[0] != '#' ||
      !std::all_of(text.begin() + 1, text.end(),
                   [](unsigned char digit) { return std::isxdigit(digit) != 0; }))
    return std::nullopt;
  const unsigned long value = std::stoul(text.substr(1), nullptr, 16);
  return glm::vec3((value >> 16) & 255, (value >> 8) & 255, value & 255) / 255.0f;
}

std::string text_of_colour(const glm::vec3& colour) {
  const glm::uvec3 bytes(glm::round(255.0f * glm::clamp(colour, 0.0f, 1.0f)));
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", bytes.x & 255u, bytes.y & 255u, bytes.z & 255u);
  return text;
}

}  // namespace octotomy::planner
