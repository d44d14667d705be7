// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace octotomy::voxel {

/// A window of int16 samples: low..high, both included.
struct Window16 {
  std::int16_t low = 0;
  std::int16_t high = 0;
};

/// The window of the int16 values in low..high; none if there are no such values.
inline std::optional<Window16> window16(double low, double high) {
  constexpr double smallest = std::numeric_limits<std::int16_t>::min();
  constexpr double largest = std::numeric_limits<std::int16_t>::max();
  const double first = std::fmax(std::ceil(low), smallest);
  const double last = std::fmin(std::floor(high), largest);
  if (!(first <= last)) return std::nullopt;
  return Window16{static_cast<std::int16_t>(first), static_cast<std::int16_t>(last)};
}

/// Bit i is set if samples[i] lies in the window, for 16 samples.
inline std::uint16_t window_bits16(const std::int16_t* samples, Window16 window) {
#if defined(__SSE2__)
  const __m128i low = _mm_set1_epi16(window.low);
  const __m128i high = _mm_set1_epi16(window.high);
  const auto outside = [&](const std::int16_t* eight) {
    const __m128i value = _mm_loadu_si128(reinterpret_cast<const __m128i*>(eight));
    return _mm_or_si128(_mm_cmplt_epi16(value, low), _mm_cmpgt_epi16(value, high));
  };
  const __m128i bytes = _mm_packs_epi16(outside(samples), outside(samples + 8));
  return static_cast<std::uint16_t>(~_mm_movemask_epi8(bytes));
#else
  std::uint16_t bits = 0;
  for (int i = 0; i < 16; ++i)
    bits = static_cast<std::uint16_t>(bits | ((samples[i] >= window.low && samples[i] <= window.high) << i));
  return bits;
#endif
}

/// Bit i is set if sample i of a leaf's 64 samples, in bit order, lies in the window.
inline std::uint64_t window_bits64(const std::int16_t* samples, Window16 window) {
  std::uint64_t word = 0;
  for (int quarter = 0; quarter < 4; ++quarter)
    word |= std::uint64_t{window_bits16(samples + 16 * quarter, window)} << (16 * quarter);
  return word;
}

}  // namespace octotomy::voxel
