// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/scan/stored_samples.h"

#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>

#include "voxel/scan/air_level.h"

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

template <typename Stored>
void take(std::span<const char> bytes, const StoredSamples& how, Scene& scene) {
  const std::size_t count = bytes.size() / sizeof(Stored);
  assert(count == scene.lattice.sample_count() && bytes.size() % sizeof(Stored) == 0);
  const bool swap = how.big_endian != (std::endian::native == std::endian::big);
  Samples<Stored> stored(count);
  std::memcpy(stored.data(), bytes.data(), count * sizeof(Stored));
  if (swap)
    for (Stored& value : stored) {
      std::array<char, sizeof(Stored)> turned;
      std::memcpy(turned.data(), &value, sizeof(Stored));
      std::reverse(turned.begin(), turned.end());
      std::memcpy(&value, turned.data(), sizeof(Stored));
    }
  if (how.slope == 1.0 && how.intercept == 0.0) return take_samples(stored, scene);
  Samples<double> values(count);
  std::transform(stored.begin(), stored.end(), values.begin(),
                 [&](Stored value) { return how.slope * static_cast<double>(value) + how.intercept; });
  take_samples(values, scene);
}

void take_by_type(std::span<const char> bytes, const StoredSamples& stored, Scene& scene) {
  switch (stored.type) {
    case SampleType::Int8:
      return take<std::int8_t>(bytes, stored, scene);
    case SampleType::UInt8:
      return take<std::uint8_t>(bytes, stored, scene);
    case SampleType::Int16:
      return take<std::int16_t>(bytes, stored, scene);
    case SampleType::UInt16:
      return take<std::uint16_t>(bytes, stored, scene);
    case SampleType::Int32:
      return take<std::int32_t>(bytes, stored, scene);
    case SampleType::UInt32:
      return take<std::uint32_t>(bytes, stored, scene);
    case SampleType::Int64:
      return take<std::int64_t>(bytes, stored, scene);
    case SampleType::UInt64:
      return take<std::uint64_t>(bytes, stored, scene);
    case SampleType::Float:
      return take<float>(bytes, stored, scene);
    case SampleType::Double:
      return take<double>(bytes, stored, scene);
  }
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

void take_bytes(std::span<const char> bytes, const StoredSamples& stored, Scene& scene) {
  try {
    take_by_type(bytes, stored, scene);
  } catch (const Error& error) {
    throw Error(error.code(), scene.source + ": " + error.what());
  }
  const AirLevel air = air_level_of_unnamed(scene);
  scene.meaning = air.meaning;
  scene.audit.push_back(air.finding);
}

}  // namespace octotomy::voxel
