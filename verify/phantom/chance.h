// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

namespace octotomy::verify {

/// Random numbers from a seed (splitmix64), the same on every machine.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ULL + 1) {}
  /// Uniform in -1/2..1/2.
  double even();
  double between(double low, double high) { return low + (high - low) * (even() + 0.5); }
  /// A random number from the standard normal distribution (Box and Muller).
  double normal();

 private:
  std::uint64_t state_;
};

}  // namespace octotomy::verify
