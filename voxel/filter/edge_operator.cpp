// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/edge_operator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "voxel/filter/measured.h"
#include "voxel/filter/slice_work.h"
#include "voxel/filter/smooth.h"
#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::voxel {
namespace {

// Reads samples by index. Beyond the scene, the border samples repeat.
template <typename Held>
class Field {
 public:
  Field(const Held& samples, const glm::ivec3& dims) : samples_(samples), dims_(dims) {}
  double operator()(int x, int y, int z) const {
    const glm::ivec3 nearest(std::clamp(x, 0, dims_.x - 1), std::clamp(y, 0, dims_.y - 1),
                             std::clamp(z, 0, dims_.z - 1));
    return static_cast<double>(samples_[sample_index(dims_, nearest)]);
  }

 private:
  const Held& samples_;
  glm::ivec3 dims_;
};

// Zucker and Hummel's derivative along each index axis. The weights are 1 for a neighbour across a face, 1 /
// sqrt 2 across an edge, 1 / sqrt 3 at a corner. The sum is divided by 2 (1 + 4 / sqrt 2 + 4 / sqrt 3), which
// is its value for a field that rises by 1 per voxel.
template <typename Held>
glm::dvec3 index_gradient(const Field<Held>& field, int x, int y, int z) {
  const double of_edge = std::sqrt(0.5);
  const double of_corner = std::sqrt(1.0 / 3.0);
  glm::dvec3 sum(0.0);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int steps = std::abs(dx) + std::abs(dy) + std::abs(dz);
        if (steps == 0) continue;
        const double weight = steps == 1 ? 1.0 : steps == 2 ? of_edge : of_corner;
        sum += weight * field(x + dx, y + dy, z + dz) * glm::dvec3(dx, dy, dz);
      }
  return sum / (2.0 * (1.0 + 4.0 * of_edge + 4.0 * of_corner));
}

// Prewitt's derivatives: the mean of the nine samples ahead minus the mean of the nine samples behind, two
// voxels apart.
template <typename Held>
glm::dvec3 plane_gradient(const Field<Held>& field, int x, int y, int z) {
  glm::dvec3 sum(0.0);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) sum += field(x + dx, y + dy, z + dz) * glm::dvec3(dx, dy, dz);
  return sum / 18.0;
}

// Roberts's derivatives in the cell of samples x..x + 1, y..y + 1, z..z + 1. The outer products of the six
// diagonals with themselves sum to four times the unit matrix.
template <typename Held>
glm::dvec3 diagonal_gradient(const Field<Held>& field, int x, int y, int z) {
  const double here = field(x, y, z);
  const double on_x = field(x + 1, y, z), on_y = field(x, y + 1, z), on_z = field(x, y, z + 1);
  const double along_xy = field(x + 1, y + 1, z) - here, across_xy = on_x - on_y;
  const double along_yz = field(x, y + 1, z + 1) - here, across_yz = on_y - on_z;
  const double along_zx = field(x + 1, y, z + 1) - here, across_zx = on_z - on_x;
  return 0.25 * glm::dvec3(along_xy + across_xy + along_zx - across_zx,
                           along_xy - across_xy + along_yz + across_yz,
                           along_yz - across_yz + along_zx + across_zx);
}

// Converts a gradient per voxel to one per millimetre.
glm::dmat3 mm_from_index_gradient(const Lattice& lattice) {
  return glm::transpose(glm::inverse(glm::dmat3(lattice.lps_from_voxel)));
}

// A float scene on the lattice of `scene`, with the sample value(x, y, z) at every index.
template <typename Value>
Scene made_of(const Scene& scene, const Progress& progress, const Value& value) {
  const glm::ivec3 dims = scene.lattice.dims;
  Scene result = empty_scene_like(scene, scene.lattice);
  result.meaning = Meaning::Raw;
  FloatSamples made(scene.lattice.sample_count());
  for_each_slice(dims.z, progress, [&](int z) {
    std::size_t at = sample_index(dims, {0, 0, z});
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) made[at++] = static_cast<float>(value(x, y, z));
  });
  result.samples = std::move(made);
  return result;
}

}  // namespace

Scene zucker_hummel(const Scene& scene, const Progress& progress) {
  check_values(scene, "an edge operator cannot take a label map");
  if (scene.padding)
    return on_measured(scene, [&](const Scene& whole) { return zucker_hummel(whole, progress); });
  const glm::dmat3 mm_from_index = mm_from_index_gradient(scene.lattice);
  return std::visit(
      [&](const auto& samples) {
        const Field field(samples, scene.lattice.dims);
        return made_of(scene, progress, [&](int x, int y, int z) {
          return glm::length(mm_from_index * index_gradient(field, x, y, z));
        });
      },
      scene.samples);
}

Scene marr_hildreth(const Scene& scene, double sigma_mm, const Progress& progress) {
  check_values(scene, "an edge operator cannot take a label map");
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const glm::dmat3 axes(scene.lattice.lps_from_voxel);
  for (int axis = 0; axis < 3; ++axis)
    // A shear below 2^-20 moves every sample of a row of 4096 voxels by less than a hundredth of a voxel.
    if (std::abs(glm::dot(axes[axis], axes[(axis + 1) % 3])) >
        0x1p-20 * spacing_mm[axis] * spacing_mm[(axis + 1) % 3])
      throw InvalidInput("a Laplacian needs perpendicular axes: resample the sheared scan first");
  if (scene.padding)
    return on_measured(scene, [&](const Scene& whole) { return marr_hildreth(whole, sigma_mm, progress); });
  Scene exact{scene.lattice, {}, scene.meaning, scene.modality, scene.source, {}};
  std::visit([&](const auto& samples) { exact.samples = FloatSamples(samples.begin(), samples.end()); },
             scene.samples);
  const Progress first{progress.stop, [&](double part) { progress.at(0.7 * part); }};
  const Scene smooth = gaussian(exact, sigma_mm, first);
  exact.samples = FloatSamples();
  const Progress second{progress.stop, [&](double part) { progress.at(0.7 + 0.3 * part); }};
  const glm::dvec3 per_square = 1.0 / (spacing_mm * spacing_mm);
  const Field field(std::get<FloatSamples>(smooth.samples), scene.lattice.dims);
  return made_of(scene, second, [&](int x, int y, int z) {
    const double here = field(x, y, z);
    return per_square.x * (field(x - 1, y, z) - 2.0 * here + field(x + 1, y, z)) +
           per_square.y * (field(x, y - 1, z) - 2.0 * here + field(x, y + 1, z)) +
           per_square.z * (field(x, y, z - 1) - 2.0 * here + field(x, y, z + 1));
  });
}

Scene roberts(const Scene& scene, const Progress& progress) {
  check_values(scene, "an edge operator cannot take a label map");
  if (scene.padding) return on_measured(scene, [&](const Scene& whole) { return roberts(whole, progress); });
  const glm::dmat3 mm_from_index = mm_from_index_gradient(scene.lattice);
  Scene result = std::visit(
      [&](const auto& samples) {
        const Field field(samples, scene.lattice.dims);
        return made_of(scene, progress, [&](int x, int y, int z) {
          return glm::length(mm_from_index * diagonal_gradient(field, x, y, z));
        });
      },
      scene.samples);
  result.lattice.lps_from_voxel[3] = glm::dvec4(scene.lattice.lps_mm(glm::dvec3(0.5)), 1.0);
  return result;
}

Scene prewitt(const Scene& scene, const Progress& progress) {
  check_values(scene, "an edge operator cannot take a label map");
  if (scene.padding) return on_measured(scene, [&](const Scene& whole) { return prewitt(whole, progress); });
  const glm::dmat3 mm_from_index = mm_from_index_gradient(scene.lattice);
  return std::visit(
      [&](const auto& samples) {
        const Field field(samples, scene.lattice.dims);
        return made_of(scene, progress, [&](int x, int y, int z) {
          return glm::length(mm_from_index * plane_gradient(field, x, y, z));
        });
      },
      scene.samples);
}

Scene difference_of_gaussians(const Scene& scene, double sigma_mm, double ratio, const Progress& progress) {
  check_values(scene, "an edge operator cannot take a label map");
  if (!(ratio > 1.0) || !std::isfinite(ratio))
    throw InvalidInput("the ratio of the wider Gaussian's sigma to the narrower one's must be above 1, not " +
                       std::to_string(ratio));
  if (scene.padding)
    return on_measured(
        scene, [&](const Scene& whole) { return difference_of_gaussians(whole, sigma_mm, ratio, progress); });
  Scene exact{scene.lattice, {}, scene.meaning, scene.modality, scene.source, {}};
  std::visit([&](const auto& samples) { exact.samples = FloatSamples(samples.begin(), samples.end()); },
             scene.samples);
  const Scene wide = gaussian(exact, ratio * sigma_mm, part_of(progress, 0.0, 0.5));
  const Scene narrow = gaussian(exact, sigma_mm, part_of(progress, 0.5, 0.9));
  const double per_square = 2.0 / (sigma_mm * sigma_mm * (ratio * ratio - 1.0));
  const auto& high = std::get<FloatSamples>(wide.samples);
  const auto& low = std::get<FloatSamples>(narrow.samples);
  return made_of(scene, part_of(progress, 0.9, 1.0), [&](int x, int y, int z) {
    const std::size_t at = sample_index(scene.lattice.dims, {x, y, z});
    return per_square * (static_cast<double>(high[at]) - static_cast<double>(low[at]));
  });
}

}  // namespace octotomy::voxel
