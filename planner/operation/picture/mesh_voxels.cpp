// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/picture/mesh_voxels.h"

#include <algorithm>
#include <stdexcept>

#include "brep/mesh/split_fans.h"
#include "convert/voxel/winding_number.h"
#include "planner/operation/file/mesh_in.h"

namespace octotomy::planner {
namespace {

constexpr double voxels_along = 400.0;

voxel::Universe universe_about(const brep::Triangles& triangles, const std::optional<double>& voxel_mm) {
  voxel::Box box{triangles.points_mm[triangles.faces[0][0]], triangles.points_mm[triangles.faces[0][0]]};
  for (const auto& face : triangles.faces)
    for (const std::uint32_t v : face) {
      box.low_mm = glm::min(box.low_mm, triangles.points_mm[v]);
      box.high_mm = glm::max(box.high_mm, triangles.points_mm[v]);
    }
  const glm::dvec3 extent_mm = box.high_mm - box.low_mm;
  const double longest_mm = std::max({extent_mm.x, extent_mm.y, extent_mm.z});
  if (!(longest_mm > 0.0)) throw std::runtime_error("has no extent, so it cannot be drawn");
  return voxel::universe_around(box, voxel_mm.value_or(longest_mm / voxels_along));
}

}  // namespace

voxel::Octree voxels_of_mesh(const std::filesystem::path& path,
                             const std::optional<voxel::Universe>& universe,
                             const std::optional<double>& voxel_mm, const FileBench& bench) {
  brep::Triangles triangles;
  {
    const Stopwatch watch(bench.timings, "read");
    // Equal points are joined, because each open edge would be a rim, and rims are slow.
    triangles = brep::joined_surface(read_mesh_in(path)).surface;
  }
  const auto refuse = [&](const std::string& why) { throw std::runtime_error(path.string() + ": " + why); };
  if (triangles.faces.empty()) refuse("has no triangles to draw");
  const Stopwatch watch(bench.timings, "voxelise");
  const voxel::Universe about = universe ? *universe : universe_about(triangles, voxel_mm);
  voxel::Octree octree = convert::voxelise_by_winding_number(about, triangles, bench.progress("voxelising"));
  if (octree.is_empty())
    refuse(
        "encloses no voxel, so it cannot be drawn: it is a sheet, inside out, thinner than a voxel or "
        "outside of the universe; octotomy info reports the reason");
  return octree;
}

}  // namespace octotomy::planner
