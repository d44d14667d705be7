// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/colour.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <stdexcept>

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

glm::vec3 need_colour(const std::string& text) {
  const std::optional<glm::vec3> colour = colour_of_text(text);
  if (!colour) throw std::runtime_error("'" + text + "' is not a colour: write #RRGGBB, for example #cc7a29");
  return *colour;
}

glm::vec3 colour_of(std::size_t number) {
  constexpr std::array<glm::vec3, 5> colours{{{0.93f, 0.89f, 0.80f},
                                              {0.20f, 0.56f, 0.72f},
                                              {0.87f, 0.49f, 0.20f},
                                              {0.16f, 0.60f, 0.47f},
                                              {0.74f, 0.45f, 0.64f}}};
  return colours[number % colours.size()];
}

glm::vec3 interference_colour() {
  return glm::vec3(0xe5, 0x48, 0x4d) / 255.0f;
}

}  // namespace octotomy::planner
