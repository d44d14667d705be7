// Separates the patient from supports, stores the supports' samples in a grey octree and overwrites them in
// the scan with air.
#include "voxel/filter/headrest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "voxel/filter/components.h"
#include "voxel/filter/label_map.h"
#include "voxel/filter/slice_work.h"
#include "voxel/space/error.h"
#include "voxel/tree/build.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::voxel {
namespace {

// Calls `visit` for every voxel, z, y and x ascending.
template <typename Visit>
void for_each_voxel(const Octree& octree, const Visit& visit) {
  for_each_slice(octree, [&](int z, const SliceBits& slice) {
    for (int y = 0; y < slice.side; ++y)
      for (int first = 0, last = -1; last + 1 < slice.side && next_run(slice, y, last + 1, first, last);)
        for (int x = first; x <= last; ++x) visit(glm::ivec3(x, y, z));
  });
}

// A value that no sample in the octree has, for the background.
std::int16_t unused_value(const Octree& octree, const Lattice& lattice, const Int16Samples& samples) {
  std::vector<bool> used(65536, false);
  for_each_voxel(octree, [&](const glm::ivec3& p) {
    used[static_cast<std::size_t>(samples[sample_index(lattice.dims, p)] + 32768)] = true;
  });
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused == used.end())
    throw Error(ErrorCode::Geometry,
                "the samples beside the patient have all 65536 values, so that none remains for the "
                "background: raise the threshold");
  return static_cast<std::int16_t>(unused - used.begin() - 32768);
}

GreyOctree kept_samples(const Octree& octree, const Lattice& lattice, const Int16Samples& samples) {
  const std::int16_t background = unused_value(octree, lattice, samples);
  std::vector<glm::ivec3> blocks;
  for_each_voxel(octree, [&](const glm::ivec3& p) {
    if (blocks.empty() || blocks.back() != p / 16) blocks.push_back(p / 16);
  });
  const auto before = [](const glm::ivec3& a, const glm::ivec3& b) {
    return std::array{a.z, a.y, a.x} < std::array{b.z, b.y, b.x};
  };
  std::sort(blocks.begin(), blocks.end(), before);
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return grey_octree_of_bricks(
      octree.universe(), background, blocks, [&](std::size_t number, GreyBrick& brick) {
        for (int z = 0; z < 16; ++z)
          for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) {
              const glm::ivec3 p = 16 * blocks[number] + glm::ivec3(x, y, z);
              brick.samples[static_cast<std::size_t>(child_index(x >> 2, y >> 2, z >> 2))]
                           [static_cast<std::size_t>(child_index(x & 3, y & 3, z & 3))] =
                  octree.contains(p) ? samples[sample_index(lattice.dims, p)] : background;
            }
      });
}

Int16Samples& int16_samples(Scene& scene) {
  auto* const samples = std::get_if<Int16Samples>(&scene.samples);
  if (samples == nullptr)
    throw InvalidInput(scene.source +
                       ": a headrest can be removed from 16-bit integer samples only, and these are "
                       "floats");
  return *samples;
}

}  // namespace

HeadrestRemoval remove_headrest(Scene scene, const HeadrestOptions& options) {
  const PatientParts parts = patient_parts(scene, options.patient);
  Int16Samples& samples = int16_samples(scene);
  const Lattice lattice = scene.lattice;
  const Universe universe = universe_on(lattice);
  Scene mask{lattice, Int16Samples(samples.size(), 0), Meaning::Raw, {}, {}, {}};
  auto& masked = std::get<Int16Samples>(mask.samples);
  std::uint64_t voxels = 0, solid = 0, dense = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (parts.of[i] != Belongs::Support) continue;
    const bool is_solid = samples[i] >= options.patient.threshold;
    masked[i] = is_solid ? 2 : 1;
    ++voxels;
    solid += is_solid;
    dense += samples[i] >= dense_hu;
  }
  options.patient.progress.at(0.85);
  HeadrestRemoval result{{},
                         kept_samples(octree_of_window(universe, mask, 1.0, 2.0), lattice, samples),
                         octree_of_window(universe, mask, 2.0, 2.0)};
  result.parts = component_count(result.solid);
  result.voxels = voxels;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (masked[i] != 0) samples[i] = options.fill;
  const double voxel_mm3 = lattice.voxel_mm3();
  result.solid_mm3 = static_cast<double>(solid) * voxel_mm3;
  result.foam_mm3 = static_cast<double>(voxels - solid) * voxel_mm3;
  result.bone_mm3 = static_cast<double>(dense) * voxel_mm3;
  result.middle_y_mm = parts.middle_y_mm;
  result.front_mm3 = parts.front_mm3;
  result.behind_mm3 = parts.behind_mm3;
  result.extruded_front_mm3 = parts.extruded_front_mm3;
  result.scene = std::move(scene);
  return result;
}

std::uint64_t restore(Scene& scene, const GreyOctree& removed) {
  check(scene);
  Int16Samples& samples = int16_samples(scene);
  const Lattice& lattice = scene.lattice;
  const Universe expected = universe_on(lattice);
  const Universe& universe = removed.universe();
  // Four points determine an affine map: the origin and one point on each axis.
  double away = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    glm::dvec3 p(0.0);
    if (corner < 3) p[corner] = lattice.dims[corner];
    const glm::dvec3 there(universe.lps_from_voxel * glm::dvec4(p, 1.0));
    away = std::max(away, glm::distance(lattice.voxel(there), p));
  }
  if (universe.depth != expected.depth || !(away <= 1e-3))
    throw InvalidInput("the removed voxels are not of " + scene.source +
                       ": they belong to another scan, or this scan was resampled after the removal");
  std::uint64_t count = 0;
  for (int z = 0; z < lattice.dims.z; ++z)
    for (int y = 0; y < lattice.dims.y; ++y)
      for (int x = 0; x < lattice.dims.x; ++x) {
        const std::int16_t sample = removed.sample({x, y, z});
        if (sample == removed.background()) continue;
        samples[sample_index(lattice.dims, {x, y, z})] = sample;
        ++count;
      }
  return count;
}

}  // namespace octotomy::voxel
