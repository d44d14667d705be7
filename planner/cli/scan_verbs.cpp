// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/cli/scan_verbs.h"

#include <array>
#include <cmath>

#include "planner/report/colour.h"
#include "voxel/filter/tissue.h"

namespace octotomy::planner::cli {

void need_hounsfield(const std::string& window, const voxel::Scene& scene) {
  if (!voxel::tissue(window) || scene.meaning == voxel::Meaning::Hounsfield) return;
  throw std::runtime_error(scene.source + ": '" + window +
                           "' is a window of Hounsfield units, which its samples are not: give LOW:HIGH, or "
                           "let octotomy segment --otsu suggest bounds");
}

glm::vec3 parse_colour(const std::string& text) {
  const std::optional<glm::vec3> colour = colour_of_text(text);
  if (!colour)
    throw CLI::ValidationError("--colour", "'" + text + "' is no colour: give #RRGGBB, for example #cc7a29");
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

}  // namespace octotomy::planner::cli
