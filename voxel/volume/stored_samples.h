// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <bitset>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "voxel/space/error.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Types of samples in files.
enum class SampleType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float, Double };
std::size_t bytes_of(SampleType type);
/// The type named "int16", "uint8", "float", "double", ...; none if the word names no type.
std::optional<SampleType> sample_type(std::string_view word);
/// The type's name, for example "float" and not "float32".
std::string name_of(SampleType type);

/// The format of stored samples and their rescale: a value is slope * stored + intercept.
struct StoredSamples {
  SampleType type = SampleType::Int16;
  bool big_endian = false;
  double slope = 1.0;
  double intercept = 0.0;

  bool is_rescaled() const { return slope != 1.0 || intercept != 0.0; }
};

/// The set of different stored numbers, if all are within 0..255 and there are at most 64 of them, as in
/// masks and label maps; else none.
using SmallNumbers = std::optional<std::bitset<256>>;

/// Sets the scene's samples: as int16 if every value is an integer in its range, else as float. `fill` writes
/// the stored samples to memory; if they are int16 without a rescale, this memory is that of the scene's
/// samples. The audit reports every change. Values that are not finite, or beyond single precision, become
/// padding below all others. Throws Error (Input) with the scene's source if no value is left; rethrows
/// exceptions of `fill`. Parallel. Memory: the stored samples and the scene's samples.
SmallNumbers take_stored(const StoredSamples& stored, Scene& scene,
                         const std::function<void(char* memory, std::size_t bytes)>& fill);

}  // namespace octotomy::voxel
