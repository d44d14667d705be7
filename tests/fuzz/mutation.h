// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace octotomy::tests {

/// The change that a mutant makes to a sound file.
enum class Mutation {
  FlipBits,       ///< 1 to 16 bits, half of the time among the first 1024 bytes
  Truncate,       ///< at any byte
  InflateNumber,  ///< a number in the first 4096 bytes, binary or in digits, becomes one of the largest
  MovePart,       ///< up to 64 bytes are repeated, removed, or exchanged for zeros
};
inline constexpr int mutation_count = 4;
const char* name_of(Mutation mutation);

/// The same mutant for the same bytes, kind and seed. Precondition: the file is not empty.
std::string mutated(const std::string& sound, Mutation mutation, std::uint64_t seed);

/// An .octree file with checksums recomputed for its present content, as far as its sections can be
/// separated. Without it, damage would never get past them.
std::string resealed_octree(std::string bytes);

/// A PNG picture with checksums recomputed for its present chunks, as far as they can be separated.
std::string resealed_png(std::string bytes);

/// The bytes as a gzip stream.
std::string packed(const std::string& bytes);

}  // namespace octotomy::tests
