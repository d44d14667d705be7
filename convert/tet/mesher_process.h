// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "voxel/space/progress.h"

namespace octotomy::convert {

// The library runs octotomy-tetgen, octotomy-mesh3 and octotomy-mesh3-labels, the executables beside it.
// Standard input carries a MesherRequest, then points, triangles, hole points, sizes and labels. Standard
// output carries a MesherAnswer, then points, tetrahedra and labels. Both sides are of one build, so the
// bytes are the machine's own.

struct MesherRequest {
  static constexpr std::uint64_t this_version = 0x6f63746f74657432ULL;

  std::uint64_t version = this_version;
  std::array<char, 64> switches{};
  std::uint64_t points = 0;            ///< three doubles each; for an image of labels, the number of its
                                       ///< planes
  std::uint64_t triangles = 0;         ///< three uint32 each
  std::uint64_t holes = 0;             ///< three doubles each
  std::uint64_t sizes = 0;             ///< a double each; for an image of labels, the number of its shares
  std::uint64_t labels = 0;            ///< a byte each, x fastest
  std::array<std::int32_t, 3> dims{};  ///< voxels of the image along each axis
  std::array<double, 3> spacing_mm{};
  std::uint64_t memory_limit_bytes = 0;
  std::uint64_t cpu_limit_seconds = 0;
  std::int64_t parent = 0;  ///< process id of the parent; the child ends when the parent does
};
struct MesherAnswer {
  std::uint64_t version = MesherRequest::this_version;
  std::uint64_t points = 0;      ///< three doubles each
  std::uint64_t tetrahedra = 0;  ///< four uint32 each
  std::uint64_t labels = 0;      ///< a uint32 each, of every tetrahedron or of none
};
/// The child's exit status is 0, or this plus the number that TetGen ended with, at most 16. Number 2 stands
/// for TetGen's internal error and any exception of CGAL.
inline constexpr int mesher_exit_base = 64;
/// Exit status: the memory limit was met.
inline constexpr int mesher_exit_memory = 90;
/// Exit status: the request could not be read, or the answer not written.
inline constexpr int mesher_exit_protocol = 91;

/// A piecewise linear complex. Mesh_3 finds cavities without hole points.
struct MesherInput {
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<glm::dvec3> holes_mm;
  std::vector<double> sizes_mm{};  ///< for Mesh_3: the largest radius of a facet's ball at each point
};
struct MesherLimits {
  /// Limit of processor time, so that other load on the machine changes no answer. The limit on the clock is
  /// most_clock_times() as long and ends a process that hangs.
  std::chrono::milliseconds time{60000};
  std::uint64_t memory_bytes = 4ull << 30;
  voxel::Progress progress{};  ///< reports the share of the time limit that is used up
};
constexpr int most_clock_times() {
  return 10;
}

struct MesherOutcome {
  /// How the mesher failed; then there are no tetrahedra.
  std::optional<std::string> failure;
  voxel::ErrorCode code = voxel::ErrorCode::Geometry;  ///< of the failure: Geometry or Resource
  bool worth_another_try = false;                      ///< other switches may succeed on the same surface
  std::vector<glm::dvec3> points_mm;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
  std::vector<std::uint32_t> labels;
};

/// Bounds for Mesh_3, as multiples of the local size: the size interpolated at the nearest point of the
/// surface, plus `grading` times the distance from there.
struct Mesh3Sizes {
  double distance = 1.0 / 15.0;  ///< largest distance of a facet's middle from the surface
  double cell = 8.0 / 3.0;       ///< largest circumradius of a tetrahedron
  double grading = 0.3;          ///< growth of the size per length
  double max_cell_mm = 1e9;      ///< largest circumradius of any tetrahedron, in mm
};
inline constexpr const char* mesh3_switches = "%lg %lg %lg %lg";

/// Runs TetGen once, in a separate process. Throws voxel::Error (Resource) if that process cannot be started,
/// voxel::Stopped.
MesherOutcome run_tetgen(const MesherInput& input, const std::string& switches, const MesherLimits& limits);

/// Runs CGAL's Mesh_3, which makes a new surface with other points. `holes_mm` holds points of the surface to
/// start from, on each of its parts. Throws as run_tetgen().
MesherOutcome run_mesh3(const MesherInput& input, const Mesh3Sizes& sizes, const MesherLimits& limits);

/// A plane by a point and its unit normal.
struct InterfacePlane {
  glm::dvec3 on_mm{0.0}, normal{0.0};

  double away_mm(const glm::dvec3& p_mm) const { return glm::dot(p_mm - on_mm, normal); }
};
/// A plane in which two labels of an image meet; the normal points from the lower label to the higher.
struct LabelPlane : InterfacePlane {
  std::uint64_t low = 0, high = 0;  ///< labels
};

/// An image of labels, a byte a voxel, x fastest. Label 0 is outside; the border is 0. The centre of voxel
/// (0, 0, 0) is the origin.
struct LabelImage {
  glm::ivec3 dims{0};
  glm::dvec3 spacing_mm{1.0};
  std::vector<std::uint8_t> labels;
  std::vector<glm::dvec3> start_mm;  ///< start points on every surface between labels
  /// Factors for the sizes, 0..1, at every `share_step`-th voxel from the first to the last or beyond, x
  /// fastest; interpolated in between. Empty: one size everywhere.
  std::vector<double> shares{};
  int share_step = 8;
  std::vector<LabelPlane> planes{};  ///< one a pair of labels at most
};
/// The number of shares along an axis of `voxels` voxels.
constexpr int share_count(int voxels, int step) {
  return (voxels - 2) / step + 2;
}
struct LabelSizes {
  double facet_mm = 2.0;     ///< largest radius of the ball about a facet between labels
  double distance_mm = 0.5;  ///< largest distance of a facet's middle from the surface
  double cell_mm = 4.0;      ///< largest circumradius of a tetrahedron
};
inline constexpr const char* label_switches = "%lg %lg %lg %d";  ///< the last is the step of shares
/// Runs CGAL's Mesh_3 over labels; the answer has the label of each tetrahedron. Throws as run_tetgen().
MesherOutcome run_mesh3(const LabelImage& image, const LabelSizes& sizes, const MesherLimits& limits);

}  // namespace octotomy::convert
