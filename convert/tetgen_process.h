// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace octotomy::convert {

// What passes between the library and octotomy-tetgen, the executable beside it: a TetgenRequest, then
// points, triangles and hole points on its standard input; a TetgenAnswer, then points and tetrahedra on its
// standard output. Both sides are always of one build, so the bytes are the machine's own.

struct TetgenRequest {
  static constexpr std::uint64_t this_version = 0x6f63746f74657431ULL;

  std::uint64_t version = this_version;
  std::array<char, 64> switches{};
  std::uint64_t points = 0;     ///< three doubles each
  std::uint64_t triangles = 0;  ///< three uint32 each
  std::uint64_t holes = 0;      ///< three doubles each
  std::uint64_t memory_limit_bytes = 0;
  std::uint64_t cpu_limit_seconds = 0;
};
struct TetgenAnswer {
  std::uint64_t version = TetgenRequest::this_version;
  std::uint64_t points = 0;      ///< three doubles each
  std::uint64_t tetrahedra = 0;  ///< four uint32 each
};
/// octotomy-tetgen's exit status is 0, or this plus the number that TetGen ended with, at most 16.
inline constexpr int tetgen_exit_base = 64;
/// Its exit status where the memory limit was met.
inline constexpr int tetgen_exit_memory = 90;
/// Its exit status where the request cannot be read or the answer not be written.
inline constexpr int tetgen_exit_protocol = 91;

/// A piecewise linear complex for TetGen.
struct TetgenInput {
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<glm::dvec3> holes_mm;
};
struct TetgenLimits {
  std::chrono::milliseconds time{60000};
  std::uint64_t memory_bytes = 4ull << 30;
  std::stop_token stop;
};
struct TetgenOutcome {
  /// How it ended when it did not do its work; then there are no tetrahedra.
  std::optional<std::string> failure;
  /// Whether the same surface may go through with other switches.
  bool worth_another_try = false;
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
};

/// Runs TetGen once, in a process of its own. Throws std::runtime_error where that process cannot be started.
TetgenOutcome run_tetgen(const TetgenInput& input, const std::string& switches, const TetgenLimits& limits);

}  // namespace octotomy::convert
