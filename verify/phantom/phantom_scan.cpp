// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/phantom/phantom_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace octotomy::verify {
namespace {

constexpr int reach = 3;  ///< of the blur to each side, in voxels

/// Samples of a box of voxels, x fastest.
struct Shares {
  glm::ivec3 first{0}, dims{0};
  std::vector<double> values;
  std::size_t index(const glm::ivec3& voxel) const {
    const glm::ivec3 at = voxel - first;
    return static_cast<std::size_t>(at.x) +
           static_cast<std::size_t>(dims.x) *
               (static_cast<std::size_t>(at.y) +
                static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(at.z));
  }
};

Shares shares_of(const voxel::PartialOctree& solid, bool near_slices_only) {
  const int side = solid.inside.universe().side();
  Shares shares{glm::ivec3(0), glm::ivec3(side), {}};
  if (near_slices_only) {
    int low = side, high = -1;
    voxel::for_each_boundary_voxel(solid, [&](const glm::ivec3& voxel, std::uint16_t) {
      low = std::min(low, voxel.z);
      high = std::max(high, voxel.z);
    });
    constexpr int more = 2 * reach + 1;
    shares.first.z = std::max(low - more, 0);
    shares.dims.z = std::min(high + more + 1, side) - shares.first.z;
  }
  shares.values.reserve(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) *
                        static_cast<std::size_t>(shares.dims.z));
  for (int z = shares.first.z; z < shares.first.z + shares.dims.z; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) shares.values.push_back(solid.inside.contains({x, y, z}) ? 1.0 : 0.0);
  voxel::for_each_boundary_voxel(solid, [&](const glm::ivec3& voxel, std::uint16_t fraction) {
    shares.values[shares.index(voxel)] = static_cast<double>(fraction) / voxel::PartialOctree::whole;
  });
  return shares;
}

void blur(Shares& shares, double deviation_voxels) {
  std::array<double, 2 * reach + 1> weight{};
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k)
    sum += weight[static_cast<std::size_t>(k + reach)] =
        std::exp(-k * k / (2.0 * deviation_voxels * deviation_voxels));
  int stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> before = shares.values;
    for (int i = 0; i < static_cast<int>(before.size()); ++i) {
      const int at = i / stride % shares.dims[axis];
      double value = 0.0;
      for (int k = -reach; k <= reach; ++k)
        if (at + k >= 0 && at + k < shares.dims[axis])
          value += weight[static_cast<std::size_t>(k + reach)] / sum *
                   before[static_cast<std::size_t>(i + k * stride)];
      shares.values[static_cast<std::size_t>(i)] = value;
    }
    stride *= shares.dims[axis];
  }
}

}  // namespace

voxel::Scene phantom_scan(const voxel::PartialOctree& solid, const PhantomScanOptions& options,
                          Chance& chance) {
  Shares shares = shares_of(solid, options.near_slices_only);
  if (options.blur_voxels > 0.0) blur(shares, options.blur_voxels);
  if (options.noise_share > 0.0)
    for (double& share : shares.values) share += options.noise_share * chance.normal();
  voxel::Scene scene;
  scene.lattice = solid.inside.universe().lattice();
  scene.lattice.lps_from_voxel[3] = glm::dvec4(scene.lattice.lps_mm(glm::dvec3(shares.first)), 1.0);
  scene.lattice.dims = shares.dims;
  voxel::Int16Samples samples;
  samples.reserve(shares.values.size());
  for (const double share : shares.values)
    samples.push_back(static_cast<std::int16_t>(std::lround(-2.0 * phantom_low * (share - 0.5))));
  scene.samples = std::move(samples);
  scene.source = "phantom";
  return scene;
}

}  // namespace octotomy::verify
