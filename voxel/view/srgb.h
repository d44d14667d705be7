// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace octotomy::voxel {

/// Converts between sRGB and linear light (IEC 61966-2-1), from linear light by a table.
class SrgbTable {
 public:
  static const SrgbTable& table();

  /// The sRGB byte of linear light. The table's index is a square root, because sRGB is nearly linear in it,
  /// so that 1024 steps suffice for all 256 values. `root` is root_steps times the square root of linear
  /// light from 0 to 1, rounded to the nearest integer.
  static constexpr float root_steps = 1023.0f;
  std::uint8_t srgb_of_root(int root) const { return to_srgb_[static_cast<std::size_t>(root)]; }
  std::uint8_t srgb(float linear) const;
  float linear(std::uint8_t srgb) const { return to_linear_[srgb]; }

 private:
  SrgbTable();
  std::array<std::uint8_t, 1024> to_srgb_{};
  std::array<float, 256> to_linear_{};
};

/// The sRGB value, 0..1, of linear light from 0 to 1.
float srgb_from_linear(float linear);

/// Linear light of an sRGB colour, 0..1.
glm::vec3 linear_from_srgb(const glm::vec3& colour);

/// Writes a linear colour as three bytes of sRGB.
void put_srgb(std::uint8_t* rgb, const glm::vec3& linear);

}  // namespace octotomy::voxel
