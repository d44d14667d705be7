// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/view/lighting.h"

#include <algorithm>
#include <cmath>

namespace octotomy::brep {

glm::vec3 lit(const glm::vec3& colour, const glm::vec3& normal, const Lighting& lighting) {
  float diffuse = lighting.ambient;
  float mirrored = 0.0f;
  for (std::size_t i = 0; i < lighting.lamps.size(); ++i) {
    const glm::vec3 towards = glm::normalize(lighting.lamps[i].towards);
    const float facing = glm::dot(normal, towards);
    if (facing <= 0.0f) continue;
    diffuse += lighting.lamps[i].strength * facing;
    if (i > 0) continue;
    const glm::vec3 reflected = 2.0f * facing * normal - towards;
    mirrored = std::pow(std::max(0.0f, -reflected.z), lighting.sharpness);  // the observer is at -look
  }
  return glm::clamp(colour * diffuse + glm::vec3(lighting.gloss * mirrored), 0.0f, 1.0f);
}

glm::vec3 linear_of_srgb(const glm::vec3& colour) {
  glm::vec3 linear;
  for (int k = 0; k < 3; ++k)
    linear[k] = colour[k] <= 0.04045f ? colour[k] / 12.92f : std::pow((colour[k] + 0.055f) / 1.055f, 2.4f);
  return linear;
}

glm::vec3 srgb_of_linear(const glm::vec3& colour) {
  glm::vec3 srgb;
  for (int k = 0; k < 3; ++k)
    srgb[k] =
        colour[k] <= 0.0031308f ? colour[k] * 12.92f : 1.055f * std::pow(colour[k], 1.0f / 2.4f) - 0.055f;
  return srgb;
}

}  // namespace octotomy::brep
