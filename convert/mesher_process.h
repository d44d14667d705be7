// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace octotomy::convert {

// What passes between the library and octotomy-tetgen, octotomy-mesh3 or octotomy-mesh3-labels, the
// executables beside it: a MesherRequest, then points, triangles, hole points, sizes and labels on its
// standard input; a MesherAnswer, then points, tetrahedra and labels on its standard output. Both sides are
// always of one build, so the bytes are the machine's own.

struct MesherRequest {
  static constexpr std::uint64_t this_version = 0x6f63746f74657432ULL;

  std::uint64_t version = this_version;
  std::array<char, 64> switches{};
  std::uint64_t points = 0;            ///< three doubles each
  std::uint64_t triangles = 0;         ///< three uint32 each
  std::uint64_t holes = 0;             ///< three doubles each
  std::uint64_t sizes = 0;             ///< a double each; of labels, the shares
  std::uint64_t labels = 0;            ///< a byte each, x fastest
  std::array<std::int32_t, 3> dims{};  ///< of the labels
  std::array<double, 3> spacing_mm{};
  std::uint64_t memory_limit_bytes = 0;
  std::uint64_t cpu_limit_seconds = 0;
};
struct MesherAnswer {
  std::uint64_t version = MesherRequest::this_version;
  std::uint64_t points = 0;      ///< three doubles each
  std::uint64_t tetrahedra = 0;  ///< four uint32 each
  std::uint64_t labels = 0;      ///< a uint32 each, of every tetrahedron or of none
};
/// The child's exit status is 0, or this plus the number that TetGen ended with, at most 16; 2 is TetGen's
/// internal error, and whatever CGAL throws.
inline constexpr int mesher_exit_base = 64;
/// Its exit status where the memory limit was met.
inline constexpr int mesher_exit_memory = 90;
/// Its exit status where the request cannot be read or the answer not be written.
inline constexpr int mesher_exit_protocol = 91;

/// A piecewise linear complex; Mesh_3 finds cavities without hole points.
struct MesherInput {
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<glm::dvec3> holes_mm;
  std::vector<double> sizes_mm{};  ///< Mesh_3's alone: at each point, the radius of a facet's ball, at most
};
struct MesherLimits {
  std::chrono::milliseconds time{60000};
  std::uint64_t memory_bytes = 4ull << 30;
  std::stop_token stop;
  std::function<void(double)> report{};  ///< called now and then with the share of the time that is gone
};
struct MesherOutcome {
  /// How it ended when it did not do its work; then there are no tetrahedra.
  std::optional<std::string> failure;
  /// Whether the same surface may go through with other switches.
  bool worth_another_try = false;
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
  std::vector<std::uint32_t> labels;
};

/// What Mesh_3 is asked for, in place of switches: lengths by the size that the input has at the nearest
/// point of the surface, or interpolates there, and that grows with the way from it.
struct Mesh3Sizes {
  double distance = 1.0 / 15.0;  ///< of a facet's middle from the surface, at most, by the size
  double cell = 8.0 / 3.0;       ///< circumradius of a tetrahedron, at most, by the size
  double grading = 0.3;          ///< by which a size grows over a length
  double max_cell_mm = 1e9;      ///< circumradius of any tetrahedron, at most
};
inline constexpr const char* mesh3_switches = "%lg %lg %lg %lg";

/// Runs TetGen once, in a process of its own. Throws std::runtime_error where that process cannot be started.
MesherOutcome run_tetgen(const MesherInput& input, const std::string& switches, const MesherLimits& limits);

/// The same of CGAL's Mesh_3, which puts points of its own on the surface. In place of hole points, the input
/// has points of the surface to start from, on each of its parts.
MesherOutcome run_mesh3(const MesherInput& input, const Mesh3Sizes& sizes, const MesherLimits& limits);

/// An image of labels, 0 outside of all regions, as it is on its border: a byte a voxel, x fastest. Voxel
/// (0, 0, 0) has its centre in the origin.
struct LabelImage {
  glm::ivec3 dims{0};
  glm::dvec3 spacing_mm{1.0};
  std::vector<std::uint8_t> labels;
  std::vector<glm::dvec3> start_mm;  ///< points of every surface between labels to start from
  /// What sizes are multiplied by, 0..1, at every `share_step`-th voxel along each axis from the first one on
  /// to at or beyond the last, x fastest, and in between: none where sizes are the same everywhere.
  std::vector<double> shares{};
  int share_step = 8;
};
/// Of so many voxels, how many have shares.
constexpr int share_count(int voxels, int step) {
  return (voxels - 2) / step + 2;
}
struct LabelSizes {
  double facet_mm = 2.0;     ///< radius of the ball about a facet between labels, at most
  double distance_mm = 0.5;  ///< of a facet's middle from the surface, at most
  double cell_mm = 4.0;      ///< circumradius of a tetrahedron, at most
};
inline constexpr const char* label_switches = "%lg %lg %lg %d";  ///< the last is the step of shares
/// The same of CGAL's Mesh_3 over labels; the answer has one of each tetrahedron.
MesherOutcome run_mesh3(const LabelImage& image, const LabelSizes& sizes, const MesherLimits& limits);

}  // namespace octotomy::convert
