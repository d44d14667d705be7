// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/edge_operator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "voxel/filter/measured.h"
#include "voxel/filter/slice_work.h"
#include "voxel/filter/smooth.h"
#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

// Samples by index; beyond the scene the border samples repeat.
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

// The derivative along each index axis. The weights are 1 for a neighbour across a face, 1 / sqrt 2 across an
// edge, 1 / sqrt 3 at a corner; a field that rises by 1 per voxel sums to 2 (1 + 4 / sqrt 2 + 4 / sqrt 3).
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

// A float scene on the same lattice with value(x, y, z) at every index.
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
  const glm::dmat3 mm_from_index = glm::transpose(glm::inverse(glm::dmat3(scene.lattice.lps_from_voxel)));
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
    // A shear of 2^-20 moves no sample of a 4096-voxel row by a hundredth of a voxel.
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

}  // namespace octotomy::voxel
