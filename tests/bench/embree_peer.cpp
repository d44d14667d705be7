// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/bench/embree_peer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <embree3/rtcore.h>
#include <stdexcept>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace octotomy::bench {
namespace {

constexpr int tile_px = 4;

std::uint8_t tone(float light) {
  return static_cast<std::uint8_t>(std::lround(255.0f * std::sqrt(std::clamp(light, 0.0f, 1.0f))));
}

}  // namespace

struct EmbreePeer::Scene {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  ~Scene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

EmbreePeer::EmbreePeer(const FlatMesh& mesh) : scene_(std::make_unique<Scene>()) {
  RTCGeometry geometry = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* points = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                         3 * sizeof(float), mesh.points_mm.size() / 3);
  void* faces = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                        3 * sizeof(std::uint32_t), mesh.faces.size() / 3);
  if (points == nullptr || faces == nullptr) throw std::runtime_error("Embree takes no mesh of this size");
  std::memcpy(points, mesh.points_mm.data(), mesh.points_mm.size() * sizeof(float));
  std::memcpy(faces, mesh.faces.data(), mesh.faces.size() * sizeof(std::uint32_t));
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneBuildQuality(scene_->scene, RTC_BUILD_QUALITY_HIGH);
  rtcCommitScene(scene_->scene);
}

EmbreePeer::~EmbreePeer() = default;

int EmbreePeer::draw(const PicturePlane& plane, std::vector<std::uint8_t>& rgb) const {
  const int side = plane.side_px;
  rgb.assign(std::size_t{3} * static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 255);
  std::atomic<int> lit = 0;
  const int tiles = (side + tile_px - 1) / tile_px;
  tbb::parallel_for(tbb::blocked_range<int>(0, tiles * tiles, 64), [&](const tbb::blocked_range<int>& range) {
    int found = 0;
    for (int tile = range.begin(); tile < range.end(); ++tile) {
      alignas(64) int valid[16];
      RTCRayHit16 packet;
      for (int lane = 0; lane < 16; ++lane) {
        const int x = tile % tiles * tile_px + lane % tile_px;
        const int y = tile / tiles * tile_px + lane / tile_px;
        valid[lane] = x < side && y < side ? -1 : 0;
        float* const origin[3] = {packet.ray.org_x, packet.ray.org_y, packet.ray.org_z};
        float* const direction[3] = {packet.ray.dir_x, packet.ray.dir_y, packet.ray.dir_z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          origin[axis][lane] = static_cast<float>(plane.first_mm[axis] + x * plane.per_px_x_mm[axis] +
                                                  y * plane.per_px_y_mm[axis]);
          direction[axis][lane] = static_cast<float>(plane.look[axis]);
        }
        packet.ray.tnear[lane] = 0.0f;
        packet.ray.tfar[lane] = static_cast<float>(plane.range_mm);
        packet.ray.time[lane] = 0.0f;
        packet.ray.mask[lane] = ~0u;
        packet.ray.flags[lane] = 0;
        packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
      }
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect16(valid, scene_->scene, &context, &packet);
      for (int lane = 0; lane < 16; ++lane) {
        if (valid[lane] == 0 || packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
        const float nx = packet.hit.Ng_x[lane], ny = packet.hit.Ng_y[lane], nz = packet.hit.Ng_z[lane];
        const float against =
            nx * packet.ray.dir_x[lane] + ny * packet.ray.dir_y[lane] + nz * packet.ray.dir_z[lane];
        const float light = std::abs(against) / std::sqrt(nx * nx + ny * ny + nz * nz);
        const int x = tile % tiles * tile_px + lane % tile_px;
        const int y = tile / tiles * tile_px + lane / tile_px;
        std::uint8_t* pixel = &rgb[std::size_t{3} * static_cast<std::size_t>(y * side + x)];
        pixel[0] = pixel[1] = pixel[2] = tone(light);
        ++found;
      }
    }
    lit += found;
  });
  return lit;
}

}  // namespace octotomy::bench
