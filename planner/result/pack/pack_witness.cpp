// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/pack/pack_witness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "planner/result/pack/numpy_array.h"
#include "voxel/tree/slice_bits.h"

namespace octotomy::planner {
namespace {

using Rows = std::vector<std::int32_t>;

/// A row of four numbers for each run of an object's voxels along x: z, y and x of its first voxel, and x
/// after its last one.
Rows runs_of(const voxel::Octree& octree) {
  Rows runs;
  voxel::SliceBits slice;
  const int side = octree.universe().side();
  for (int z = 0; z < side; ++z) {
    voxel::read_slice(octree, z, slice);
    for (int y = 0; y < side; ++y) {
      const std::uint64_t* words = slice.row(y);
      const auto is_in = [&](int x) { return (words[x / 64] >> (x % 64) & 1U) != 0; };
      for (int x = 0; x < side;) {
        if (words[x / 64] >> (x % 64) == 0) {
          x = (x / 64 + 1) * 64;
        } else if (!is_in(x)) {
          ++x;
        } else {
          const int first = x;
          while (x < side && is_in(x)) ++x;
          runs.insert(runs.end(), {z, y, first, x});
        }
      }
    }
  }
  return runs;
}

/// The cell of a scan that contains a voxel's centre, and the samples at its eight corners.
struct CellSamples {
  glm::ivec3 cell{0};
  std::array<double, 8> samples{};
};

/// The cell around a point. None if the point is outside of the samples' centres or if a corner has no
/// measured sample, because no kernel interpolates there.
std::optional<CellSamples> cell_at(const voxel::Scene& scene, const glm::dvec3& centre_mm) {
  const glm::dvec3 at = scene.lattice.voxel(centre_mm);
  const glm::ivec3 dims = scene.lattice.dims;
  CellSamples found;
  for (int axis = 0; axis < 3; ++axis) {
    // A point on the last sample belongs to the last cell.
    if (!(at[axis] >= 0.0 && at[axis] <= dims[axis] - 1.0) || dims[axis] < 2) return std::nullopt;
    found.cell[axis] = std::min(static_cast<int>(at[axis]), dims[axis] - 2);
  }
  std::visit(
      [&](const auto& samples) {
        for (int corner = 0; corner < 8; ++corner) {
          const glm::ivec3 p = found.cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
          found.samples[corner] =
              static_cast<double>(samples[(static_cast<std::size_t>(p.z) * dims.y + p.y) * dims.x + p.x]);
        }
      },
      scene.samples);
  for (const double sample : found.samples)
    if (!std::isfinite(sample) || sample == scene.padding) return std::nullopt;
  return found;
}

/// Chooses `most_samples` voxels. At most half of them are at the beginning of runs: first voxels, and the
/// voxels before them. The others are random.
std::vector<glm::ivec3> chosen_voxels(const Rows& runs, int side) {
  std::vector<glm::ivec3> voxels;
  const std::size_t count = runs.size() / 4, quarter = most_samples / 4;
  const std::size_t step = std::max<std::size_t>(1, count / quarter);
  for (std::size_t i = 0; i < count && voxels.size() < 2 * quarter; i += step) {
    const glm::ivec3 first{runs[4 * i + 2], runs[4 * i + 1], runs[4 * i]};
    voxels.push_back(first);
    if (first.x > 0) voxels.push_back(first - glm::ivec3(1, 0, 0));
  }
  // A linear congruential generator (Knuth's MMIX) with a fixed seed, so that equal plans make equal packs.
  std::uint64_t state = 1;
  const auto next = [&state, side] {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<int>((state >> 33) % static_cast<unsigned>(side));
  };
  while (voxels.size() < most_samples) {
    const int x = next(), y = next(), z = next();
    voxels.emplace_back(x, y, z);
  }
  return voxels;
}

std::vector<double> sample_rows(const voxel::Scene& scan, const voxel::Universe& universe, const Rows& runs) {
  std::vector<double> rows;
  for (const glm::ivec3& at : chosen_voxels(runs, universe.side())) {
    const auto found = cell_at(scan, universe.lattice().lps_mm(glm::dvec3(at)));
    if (!found) continue;
    for (int axis = 0; axis < 3; ++axis) rows.push_back(at[axis]);
    for (int axis = 0; axis < 3; ++axis) rows.push_back(found->cell[axis]);
    rows.insert(rows.end(), found->samples.begin(), found->samples.end());
  }
  return rows;
}

}  // namespace

std::map<std::string, std::string> witness_arrays(const Object& object, const voxel::Universe& universe,
                                                  const voxel::Scene* window_of) {
  std::map<std::string, std::string> arrays;
  const Rows runs = runs_of(object.voxel.octree);
  arrays["runs"] = numpy_array(runs, 4);
  // Tools have these arrays too, because the result states their volume and area.
  if (object.mesh.within) {
    const brep::Triangles& triangles = object.mesh.within->triangles();
    std::vector<double> points;
    points.reserve(3 * triangles.points_mm.size());
    for (const glm::dvec3& p : triangles.points_mm) points.insert(points.end(), {p.x, p.y, p.z});
    Rows faces;
    faces.reserve(3 * triangles.faces.size());
    for (const auto& face : triangles.faces)
      for (const std::uint32_t point : face) faces.push_back(static_cast<std::int32_t>(point));
    arrays["points"] = numpy_array(points, 3);
    arrays["triangles"] = numpy_array(faces, 3);
  }
  if (window_of != nullptr) arrays["samples"] = numpy_array(sample_rows(*window_of, universe, runs), 14);
  return arrays;
}

}  // namespace octotomy::planner
