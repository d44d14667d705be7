// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/volume/stored_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <type_traits>
#include <utility>

namespace octotomy::voxel {
namespace {

constexpr std::array<std::pair<std::string_view, SampleType>, 12> named_types{
    {{"int8", SampleType::Int8},
     {"uint8", SampleType::UInt8},
     {"int16", SampleType::Int16},
     {"uint16", SampleType::UInt16},
     {"int32", SampleType::Int32},
     {"uint32", SampleType::UInt32},
     {"int64", SampleType::Int64},
     {"uint64", SampleType::UInt64},
     {"float", SampleType::Float},
     {"float32", SampleType::Float},
     {"double", SampleType::Double},
     {"float64", SampleType::Double}}};

/// Facts about the values, collected in one pass.
struct Values {
  std::size_t unreal_count = 0;  ///< number of values that are not finite, or infinite in single precision
  bool fits_int16 = true;
  bool is_exact = true;  ///< whether every value is exact in single precision
  double low = std::numeric_limits<double>::infinity();

  Values operator+(const Values& other) const {
    return {unreal_count + other.unreal_count, fits_int16 && other.fits_int16, is_exact && other.is_exact,
            std::min(low, other.low)};
  }
};

bool is_kept(double real) {
  return std::abs(real) <= static_cast<double>(std::numeric_limits<float>::max());
}

/// Whether a 64-bit integer is exact in double precision.
template <typename Stored>
bool is_double(Stored value) {
  if constexpr (std::is_integral_v<Stored> && sizeof(Stored) == 8) {
    // 2^63 and 2^64 are exact doubles but exceed the range of the type, so converting them back would be
    // undefined.
    constexpr double beyond = std::is_signed_v<Stored> ? 0x1p63 : 0x1p64;
    const auto real = static_cast<double>(value);
    return real < beyond && static_cast<Stored>(real) == value;
  }
  return true;
}

template <typename Stored>
Values values_of(std::span<const Stored> part, const StoredSamples& how) {
  Values found;
  for (const Stored value : part) {
    const double real = how.slope * static_cast<double>(value) + how.intercept;
    if (!is_kept(real)) {
      ++found.unreal_count;
      continue;
    }
    found.fits_int16 = found.fits_int16 && real >= std::numeric_limits<std::int16_t>::min() &&
                       real <= std::numeric_limits<std::int16_t>::max() && real == std::trunc(real);
    found.is_exact =
        found.is_exact && static_cast<double>(static_cast<float>(real)) == real && is_double(value);
    found.low = std::min(found.low, real);
  }
  return found;
}

constexpr std::size_t grain = std::size_t{1} << 16;

template <typename Stored>
SmallNumbers small_numbers(std::span<const Stored> stored) {
  constexpr std::size_t most = 64;
  std::bitset<256> seen;
  std::size_t count = 0;
  for (const Stored value : stored) {
    const auto real = static_cast<double>(value);
    if (!(real >= 0.0 && real <= 255.0 && real == std::trunc(real))) return std::nullopt;
    const auto number = static_cast<std::size_t>(value);
    if (seen[number]) continue;
    if (++count > most) return std::nullopt;
    seen.set(number);
  }
  return seen;
}

template <typename Stored>
void turn_bytes(Samples<Stored>& stored, bool big_endian) {
  if (sizeof(Stored) == 1 || big_endian == (std::endian::native == std::endian::big)) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, stored.size(), grain), [&](const auto& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      std::array<char, sizeof(Stored)> turned;
      std::memcpy(turned.data(), &stored[i], sizeof(Stored));
      std::reverse(turned.begin(), turned.end());
      std::memcpy(&stored[i], turned.data(), sizeof(Stored));
    }
  });
}

/// A value below every measured sample that the samples' type can represent; for int16 an integer. None if
/// single precision has no such number.
std::optional<double> padding_below(const Values& found) {
  if (found.fits_int16 && found.low > std::numeric_limits<std::int16_t>::min()) return found.low - 1.0;
  const auto low = static_cast<float>(found.low);
  const float below = std::min(low - 1.0f, std::nextafter(low, -std::numeric_limits<float>::infinity()));
  return std::isfinite(below) ? std::optional<double>(below) : std::nullopt;
}

template <typename Stored, typename Sample>
void convert(const Samples<Stored>& stored, const StoredSamples& how, double in_place,
             Samples<Sample>& samples) {
  samples.resize(stored.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, stored.size(), grain), [&](const auto& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      const double real = how.slope * static_cast<double>(stored[i]) + how.intercept;
      samples[i] = static_cast<Sample>(is_kept(real) ? real : in_place);
    }
  });
}

template <typename Stored>
void put_values(const Samples<Stored>& stored, const StoredSamples& how, Scene& scene) {
  const Values found = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, stored.size(), grain), Values{},
      [&](const auto& part, const Values& values) {
        return values + values_of(std::span(stored).subspan(part.begin(), part.size()), how);
      },
      std::plus<>());
  if (found.unreal_count == stored.size())
    throw Error(ErrorCode::Input, scene.source + ": no sample is a finite number");
  double in_place = found.low;
  bool fits_int16 = found.fits_int16;
  if (found.unreal_count > 0) {
    scene.padding = padding_below(found);
    in_place = scene.padding.value_or(found.low);
    fits_int16 = fits_int16 && in_place >= std::numeric_limits<std::int16_t>::min();
    scene.audit.push_back({"finite", Verdict::Warn,
                           std::to_string(found.unreal_count) +
                               " samples are not finite numbers in single precision; they are " +
                               (scene.padding ? "taken as not measured" : "set to the lowest value") +
                               " and hold " + std::to_string(in_place)});
  }
  if (fits_int16) return convert(stored, how, in_place, scene.samples.emplace<Int16Samples>());
  convert(stored, how, in_place, scene.samples.emplace<FloatSamples>());
  if (!found.is_exact)
    scene.audit.push_back({"precision", Verdict::Warn,
                           std::string("samples are rounded to single precision") +
                               (std::is_integral_v<Stored>
                                    ? ", which merges whole numbers from 16777216 on: labels must be smaller"
                                    : "")});
}

using Fill = std::function<void(char* memory, std::size_t bytes)>;

template <typename Stored>
SmallNumbers take(const StoredSamples& how, Scene& scene, const Fill& fill) {
  const std::size_t count = scene.lattice.sample_count();
  const auto filled = [&](Samples<Stored>& stored) {
    fill(reinterpret_cast<char*>(stored.data()), count * sizeof(Stored));
    turn_bytes(stored, how.big_endian);
    return small_numbers(std::span<const Stored>(stored));
  };
  if constexpr (std::is_same_v<Stored, std::int16_t>)
    if (!how.is_rescaled()) return filled(scene.samples.emplace<Int16Samples>(count));
  Samples<Stored> stored(count);
  SmallNumbers small = filled(stored);
  put_values(stored, how, scene);
  return small;
}

}  // namespace

std::size_t bytes_of(SampleType type) {
  switch (type) {
    case SampleType::Int8:
    case SampleType::UInt8:
      return 1;
    case SampleType::Int16:
    case SampleType::UInt16:
      return 2;
    case SampleType::Int32:
    case SampleType::UInt32:
    case SampleType::Float:
      return 4;
    default:
      return 8;
  }
}

std::optional<SampleType> sample_type(std::string_view word) {
  for (const auto& [name, type] : named_types)
    if (name == word) return type;
  return std::nullopt;
}

std::string name_of(SampleType type) {
  for (const auto& [name, known] : named_types)
    if (known == type) return std::string(name);
  throw std::invalid_argument("no type of samples");
}

SmallNumbers take_stored(const StoredSamples& stored, Scene& scene, const Fill& fill) {
  switch (stored.type) {
    case SampleType::Int8:
      return take<std::int8_t>(stored, scene, fill);
    case SampleType::UInt8:
      return take<std::uint8_t>(stored, scene, fill);
    case SampleType::Int16:
      return take<std::int16_t>(stored, scene, fill);
    case SampleType::UInt16:
      return take<std::uint16_t>(stored, scene, fill);
    case SampleType::Int32:
      return take<std::int32_t>(stored, scene, fill);
    case SampleType::UInt32:
      return take<std::uint32_t>(stored, scene, fill);
    case SampleType::Int64:
      return take<std::int64_t>(stored, scene, fill);
    case SampleType::UInt64:
      return take<std::uint64_t>(stored, scene, fill);
    case SampleType::Float:
      return take<float>(stored, scene, fill);
    case SampleType::Double:
      return take<double>(stored, scene, fill);
  }
  throw std::invalid_argument("no type of samples");
}

}  // namespace octotomy::voxel
