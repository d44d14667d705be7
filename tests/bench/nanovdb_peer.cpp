// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/nanovdb_peer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <nanovdb/util/GridHandle.h>
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/Ray.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace octotomy::bench {
namespace {

constexpr int tile_px = 8;

std::uint8_t tone(float light) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::sqrt(std::clamp(light, 0.0f, 1.0f))));
}

nanovdb::Vec3f vec(const Triple& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

}  // namespace

struct NanoVdbPeer::Grid {
  nanovdb::GridHandle<nanovdb::HostBuffer> handle;
};

NanoVdbPeer::NanoVdbPeer(const FlatMesh& mesh, double voxel_mm) : grid_(std::make_unique<Grid>()) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  for (std::size_t i = 0; i < mesh.points_mm.size(); i += 3)
    points.emplace_back(mesh.points_mm[i], mesh.points_mm[i + 1], mesh.points_mm[i + 2]);
  std::vector<openvdb::Vec3I> triangles;
  for (std::size_t i = 0; i < mesh.faces.size(); i += 3)
    triangles.emplace_back(mesh.faces[i], mesh.faces[i + 1], mesh.faces[i + 2]);
  const openvdb::FloatGrid::Ptr level_set = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(voxel_mm), points, triangles);
  grid_->handle = nanovdb::openToNanoVDB(*level_set);
}

NanoVdbPeer::~NanoVdbPeer() = default;

int NanoVdbPeer::draw(const PicturePlane& plane, std::vector<std::uint8_t>& rgb) const {
  using Ray = nanovdb::Ray<float>;
  const nanovdb::FloatGrid& grid = *grid_->handle.grid<float>();
  const int side = plane.side_px, tiles = (side + tile_px - 1) / tile_px;
  rgb.assign(std::size_t{3} * static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 255);
  std::atomic<int> lit = 0;
  tbb::parallel_for(tbb::blocked_range<int>(0, tiles * tiles, 16), [&](const tbb::blocked_range<int>& range) {
    auto values = grid.getAccessor();
    const nanovdb::Vec3f look = vec(plane.look);
    int found = 0;
    for (int tile = range.begin(); tile < range.end(); ++tile)
      for (int i = 0; i < tile_px * tile_px; ++i) {
        const int x = tile % tiles * tile_px + i % tile_px, y = tile / tiles * tile_px + i / tile_px;
        if (x >= side || y >= side) continue;
        Triple from = plane.first_mm;
        for (std::size_t axis = 0; axis < 3; ++axis)
          from[axis] += x * plane.per_px_x_mm[axis] + y * plane.per_px_y_mm[axis];
        Ray ray = Ray(vec(from), look, 0.0f, static_cast<float>(plane.range_mm)).worldToIndexF(grid);
        nanovdb::Coord at;
        float value = 0.0f, time = 0.0f;
        if (!nanovdb::ZeroCrossing(ray, values, at, value, time)) continue;
        const nanovdb::Vec3f gradient(values.getValue(at.offsetBy(1, 0, 0)) - value,
                                      values.getValue(at.offsetBy(0, 1, 0)) - value,
                                      values.getValue(at.offsetBy(0, 0, 1)) - value);
        const float light = std::abs(gradient.dot(look)) / std::max(gradient.length(), 1e-6f);
        std::uint8_t* pixel = &rgb[std::size_t{3} * static_cast<std::size_t>(y * side + x)];
        pixel[0] = pixel[1] = pixel[2] = tone(light);
        ++found;
      }
    lit += found;
  });
  return lit;
}

}  // namespace octotomy::bench
