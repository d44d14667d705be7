// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "voxel/space/error.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Types of samples in files.
enum class SampleType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float, Double };
std::size_t bytes_of(SampleType type);
/// "int16", "uint8", "float", "double", ...; none if the word names no type.
std::optional<SampleType> sample_type(std::string_view word);
/// The type's word, for example "float" and not "float32".
std::string name_of(SampleType type);

/// The format of stored samples and their rescale: a value is slope * stored + intercept.
struct StoredSamples {
  SampleType type = SampleType::Int16;
  bool big_endian = false;
  double slope = 1.0;
  double intercept = 0.0;
};
/// Reads the samples of a file that does not state its modality, as take_samples() does. Their meaning is
/// judged by their air (air_level.h) and stated in the audit. Precondition: the bytes are those of the
/// lattice's samples. Throws as take_samples(), naming the scene's source.
void take_bytes(std::span<const char> bytes, const StoredSamples& stored, Scene& scene);

/// Puts samples into the scene: as int16 if every one is an integer in its range, else as float. The audit
/// states every change. Numbers that are not finite, or beyond single precision, become the lowest of the
/// others. Throws Error, Input, without a path, if there are no others.
template <typename Stored, typename Allocator>
void take_samples(const std::vector<Stored, Allocator>& stored, Scene& scene) {
  constexpr double int16_low = std::numeric_limits<std::int16_t>::min();
  constexpr double int16_high = std::numeric_limits<std::int16_t>::max();
  // Greater ones would become infinite in single precision.
  constexpr double largest = std::numeric_limits<float>::max();
  const auto is_kept = [](double real) { return std::abs(real) <= largest; };
  std::size_t unreal_count = 0;
  bool fits = true;
  bool is_exact = true;
  double low = std::numeric_limits<double>::infinity();
  for (const Stored value : stored) {
    const auto real = static_cast<double>(value);
    if (!is_kept(real)) {
      ++unreal_count;
      continue;
    }
    fits = fits && real >= int16_low && real <= int16_high && real == std::trunc(real);
    is_exact = is_exact && static_cast<double>(static_cast<float>(real)) == real;
    low = std::min(low, real);
  }
  if (unreal_count == stored.size()) throw Error(ErrorCode::Input, "no sample is a finite number");
  if (unreal_count > 0)
    scene.audit.push_back({"finite", Verdict::Warn,
                           std::to_string(unreal_count) +
                               " samples are no finite numbers of single precision; they are set to the "
                               "lowest value, " +
                               std::to_string(low)});
  const auto convert = [&](auto& samples) {
    using Sample = typename std::decay_t<decltype(samples)>::value_type;
    samples.resize(stored.size());
    std::transform(stored.begin(), stored.end(), samples.begin(), [&](Stored value) {
      const auto real = static_cast<double>(value);
      return static_cast<Sample>(is_kept(real) ? real : low);
    });
  };
  if (fits) {
    convert(scene.samples.emplace<Int16Samples>());
    return;
  }
  convert(scene.samples.emplace<FloatSamples>());
  if (!is_exact)
    scene.audit.push_back({"precision", Verdict::Warn, "samples are rounded to single precision"});
}

}  // namespace octotomy::voxel
