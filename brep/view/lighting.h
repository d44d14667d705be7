// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace octotomy::brep {

/// A light with parallel rays.
struct Lamp {
  glm::vec3 towards{-0.45f, 0.55f, -1.0f};  ///< (right, up, look), from the surface to the lamp; any length
  float strength = 0.9f;                    ///< share of white on a surface that faces it, 0..1
};

/// Phong's model (1975): ambient light, Lambert's law for each lamp, and the first lamp's mirror image.
struct Lighting {
  std::vector<Lamp> lamps{Lamp{}, Lamp{{0.7f, -0.25f, -1.0f}, 0.25f}};
  float ambient = 0.06f;    ///< light from everywhere, 0..1
  float gloss = 0.06f;      ///< strength of the mirror image, 0..1
  float sharpness = 32.0f;  ///< exponent of the mirror image: larger is narrower
};

/// Linear light, 0..1, of a surface. `normal` is in (right, up, look), of unit length, on the observer's side;
/// `colour` is linear light.
glm::vec3 lit(const glm::vec3& colour, const glm::vec3& normal, const Lighting& lighting);

/// Linear light of sRGB, 0..1 (IEC 61966-2-1), and back.
glm::vec3 linear_of_srgb(const glm::vec3& colour);
glm::vec3 srgb_of_linear(const glm::vec3& colour);

}  // namespace octotomy::brep
