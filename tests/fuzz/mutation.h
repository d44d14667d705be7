// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

namespace octotomy::tests {

/// What a mutant does to a file that is sound.
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

/// An .octree file with checksums that are right for what it holds now, as far as its sections can be told
/// apart; without it damage never gets past them.
std::string resealed_octree(std::string bytes);

/// A PNG picture with the checksums of what its chunks hold now, as far as they can be told apart.
std::string resealed_png(std::string bytes);

/// As a gzip stream.
std::string packed(const std::string& bytes);

}  // namespace octotomy::tests
