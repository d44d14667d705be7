// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/chance.h"

#include <cmath>
#include <numbers>

namespace octotomy::verify {

double Chance::even() {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1.0p-53 - 0.5;
}

double Chance::normal() {
  const double radius = std::sqrt(-2.0 * std::log(even() + 0.5 + 0x1.0p-54));
  return radius * std::cos(2.0 * std::numbers::pi * even());
}

}  // namespace octotomy::verify
