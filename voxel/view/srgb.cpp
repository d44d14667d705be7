// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/view/srgb.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octotomy::voxel {
namespace {

float linear_from_srgb(float value) {
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

}  // namespace

float srgb_from_linear(float linear) {
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

SrgbTable::SrgbTable() {
  for (std::size_t i = 0; i < to_srgb_.size(); ++i) {
    const float root = static_cast<float>(i) / root_steps;
    to_srgb_[i] = static_cast<std::uint8_t>(std::lround(255.0f * srgb_from_linear(root * root)));
  }
  for (std::size_t i = 0; i < to_linear_.size(); ++i)
    to_linear_[i] = linear_from_srgb(static_cast<float>(i) / 255.0f);
}

const SrgbTable& SrgbTable::table() {
  static const SrgbTable table;
  return table;
}

std::uint8_t SrgbTable::srgb(float linear) const {
  assert(!std::isnan(linear));
  constexpr float to_nearest = 0.5f;
  return srgb_of_root(static_cast<int>(to_nearest + std::sqrt(std::clamp(linear, 0.0f, 1.0f)) * root_steps));
}

glm::vec3 linear_from_srgb(const glm::vec3& colour) {
  return {linear_from_srgb(colour.x), linear_from_srgb(colour.y), linear_from_srgb(colour.z)};
}

void put_srgb(std::uint8_t* rgb, const glm::vec3& linear) {
  for (int channel = 0; channel < 3; ++channel) rgb[channel] = SrgbTable::table().srgb(linear[channel]);
}

}  // namespace octotomy::voxel
