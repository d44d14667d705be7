// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/table/number_format.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace octotomy::planner {
namespace {

constexpr const char* narrow_space = "\u202f";
constexpr const char* minus = "\u2212";
constexpr const char* none = "\u2013";

}  // namespace

std::string grouped(double value, int decimals) {
  if (!std::isfinite(value)) return none;
  char digits[400];
  std::snprintf(digits, sizeof digits, "%.*f", decimals, std::abs(value));
  const std::string text = digits;
  const std::size_t whole = std::min(text.find('.'), text.size());
  std::string result = value < 0.0 && text.find_first_of("123456789") != std::string::npos ? minus : "";
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (whole > 4 && i > 0 && i < whole && (whole - i) % 3 == 0) result += narrow_space;
    result += text[i];
  }
  return result;
}

std::string three_figures(double value) {
  if (value == 0.0 || !std::isfinite(value)) return grouped(value, 0);
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  return grouped(value, std::clamp(2 - exponent, 0, 6));
}

std::string plain(double value) {
  if (std::abs(value) >= 1e15) {
    char digits[40];
    std::snprintf(digits, sizeof digits, "%g", value);
    return digits;
  }
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string plain(const voxel::Box& box) {
  const auto axis = [&](char name, int i) {
    return std::string(1, name) + " " + plain(box.low_mm[i]) + ".." + plain(box.high_mm[i]);
  };
  return axis('x', 0) + ", " + axis('y', 1) + ", " + axis('z', 2) + " mm";
}

}  // namespace octotomy::planner
