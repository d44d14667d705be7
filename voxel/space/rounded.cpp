// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/rounded.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace octotomy::voxel {

std::string rounded(double value) {
  if (std::isnan(value)) return "not a number";
  if (std::isinf(value)) return value > 0.0 ? "infinitely many" : "minus infinitely many";
  if (value == 0.0) return "0";
  constexpr int digits = 3;
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  // Rounds before printing, so that 1876 becomes 1880, not 1.88e+03.
  const double unit = std::pow(10.0, exponent - digits + 1);
  char text[64];
  if (exponent < -4 || exponent > 14)
    std::snprintf(text, sizeof text, "%.2e", value);
  else
    std::snprintf(text, sizeof text, "%.*f", std::max(digits - 1 - exponent, 0),
                  exponent >= digits ? std::round(value / unit) * unit : value);
  std::string number = text;
  if (number.find('.') != std::string::npos && number.find('e') == std::string::npos) {
    while (number.back() == '0') number.pop_back();
    if (number.back() == '.') number.pop_back();
  }
  return number;
}

std::string rounded(const glm::dvec3& p_mm) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    char number[32];
    // Adding zero turns a rounded minus zero into zero.
    std::snprintf(number, sizeof number, "%.0f", std::round(p_mm[axis]) + 0.0);
    text += (axis == 0 ? "(" : ", ") + std::string(number);
  }
  return text + ")";
}

}  // namespace octotomy::voxel
