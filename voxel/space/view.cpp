// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/view.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

View looking(const glm::dvec3& look, const glm::dvec3& up) {
  return {look, up, glm::cross(look, up)};
}

const std::array<std::pair<std::string_view, View>, 6> named_views{{
    {"anterior", looking({0, 1, 0}, {0, 0, 1})},
    {"posterior", looking({0, -1, 0}, {0, 0, 1})},
    {"left", looking({-1, 0, 0}, {0, 0, 1})},
    {"right", looking({1, 0, 0}, {0, 0, 1})},
    {"superior", looking({0, 0, -1}, {0, -1, 0})},
    {"inferior", looking({0, 0, 1}, {0, -1, 0})},
}};

}  // namespace

bool is_frame(const View& view) {
  constexpr double rounding = 1e-6;
  const auto is = [](double value, double expected) { return std::abs(value - expected) <= rounding; };
  return is(glm::dot(view.look, view.look), 1.0) && is(glm::dot(view.up, view.up), 1.0) &&
         is(glm::dot(view.look, view.up), 0.0) &&
         is(glm::distance(view.right, glm::cross(view.look, view.up)), 0.0);
}

View parse_view(const std::string& text) {
  for (const auto& [name, view] : named_views)
    if (text == name) return view;
  char* end = nullptr;
  const double azimuth_deg = std::strtod(text.c_str(), &end);
  const bool has_comma = end != text.c_str() && *end == ',';
  const char* second = has_comma ? end + 1 : end;
  const double elevation_deg = has_comma ? std::strtod(second, &end) : 0.0;
  if (!has_comma || end == second || *end != '\0' || !std::isfinite(azimuth_deg) ||
      !std::isfinite(elevation_deg) || std::abs(elevation_deg) > 90.0)
    throw InvalidInput("no view '" + text +
                       "': use anterior, posterior, left, right, superior, inferior, or AZ,EL in degrees "
                       "with EL from -90 to 90, for example 30,15");
  const double azimuth = azimuth_deg * std::numbers::pi / 180.0;
  const double elevation = elevation_deg * std::numbers::pi / 180.0;
  const double level = std::cos(elevation);
  // The observer is in the direction -look: in front of the patient (y < 0) at azimuth 0, at the patient's
  // left (x > 0) at 90 degrees.
  const glm::dvec3 look(-std::sin(azimuth) * level, std::cos(azimuth) * level, -std::sin(elevation));
  const glm::dvec3 up(-std::sin(azimuth) * std::sin(elevation), std::cos(azimuth) * std::sin(elevation),
                      level);
  return looking(look, up);
}

std::array<View, 2> stereo_pair(const View& view, double between_deg) {
  assert(std::isfinite(between_deg));
  const double half = 0.5 * between_deg * std::numbers::pi / 180.0;
  // The left eye is at the observer's left, so it looks slightly to the right.
  const auto turned = [&](double angle) {
    return looking(std::cos(angle) * view.look + std::sin(angle) * view.right, view.up);
  };
  return {turned(half), turned(-half)};
}

}  // namespace octotomy::voxel
