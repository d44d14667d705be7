// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Passes:
//   1 make the octree of the solid samples, on the scan's own voxels;
//   2 take out a board that runs through the scan, if asked for; of the rest take its largest part for the
//   patient, after an opening if links are to be cut; 3 mark each other part that has a voxel farther than
//   near_mm from the patient; 4 mark the rim of these parts, except voxels as near to the patient; 5 keep the
//   marked samples as a grey octree and overwrite them with air.
#include "voxel/filter/headrest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "voxel/filter/board.h"
#include "voxel/filter/components.h"
#include "voxel/filter/label_map.h"
#include "voxel/filter/morphology.h"
#include "voxel/filter/slice_work.h"
#include "voxel/solid/combine.h"
#include "voxel/tree/build.h"
#include "voxel/tree/slice_build.h"

namespace octotomy::voxel {
namespace {

void check_options(const HeadrestOptions& options) {
  const auto is_length = [](double value) { return std::isfinite(value) && value >= 0.0; };
  if (!std::isfinite(options.threshold) || !is_length(options.near_mm) || !is_length(options.rim_mm) ||
      (options.detach_mm && !is_length(*options.detach_mm)) ||
      (options.board_mm && !(is_length(*options.board_mm) && *options.board_mm > 0.0)))
    throw std::invalid_argument("a headrest's threshold must be finite, its lengths finite and not negative");
}

// The first voxel of every run along x.
std::vector<glm::ivec3> run_starts(const Octree& octree) {
  std::vector<glm::ivec3> starts;
  for_each_slice(octree, [&](int z, const SliceBits& slice) {
    for (int y = 0; y < slice.side; ++y)
      for (int first = 0, last = -1; last + 1 < slice.side && next_run(slice, y, last + 1, first, last);)
        starts.emplace_back(first, y, z);
  });
  return starts;
}

// Calls `visit` for every voxel, z, y and x ascending.
template <typename Visit>
void for_each_voxel(const Octree& octree, const Visit& visit) {
  for_each_slice(octree, [&](int z, const SliceBits& slice) {
    for (int y = 0; y < slice.side; ++y)
      for (int first = 0, last = -1; last + 1 < slice.side && next_run(slice, y, last + 1, first, last);)
        for (int x = first; x <= last; ++x) visit(glm::ivec3(x, y, z));
  });
}

// Pass 3: the parts of `rest` to remove.
Octree foreign_parts(const Octree& rest, const Octree& patient, const Lattice& lattice,
                     const HeadrestOptions& options) {
  const Universe& universe = rest.universe();
  const Octree far = combine(universe, Expression(rest) - dilate(patient, options.near_mm));
  options.progress.at(0.6);
  Octree foreign = components_at(rest, run_starts(far));
  if (options.keep_mm.empty()) return foreign;
  std::vector<glm::ivec3> kept;
  for (const glm::dvec3& p_mm : options.keep_mm) kept.emplace_back(glm::floor(lattice.voxel(p_mm) + 0.5));
  return combine(universe, Expression(foreign) - components_at(rest, kept));
}

// A value that no sample in the octree has.
std::int16_t unused_value(const Octree& octree, const Lattice& lattice, const Int16Samples& samples) {
  std::vector<bool> used(65536, false);
  for_each_voxel(octree, [&](const glm::ivec3& p) {
    used[static_cast<std::size_t>(samples[sample_index(lattice.dims, p)] + 32768)] = true;
  });
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused == used.end())
    throw Error(ErrorCode::Geometry,
                "the samples beside the patient take all 65536 values, so that none is left for the "
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
    throw std::invalid_argument(scene.source +
                                ": a headrest can be removed from 16-bit integer samples only, and these are "
                                "floats");
  return *samples;
}

}  // namespace

HeadrestRemoval remove_headrest(Scene scene, const HeadrestOptions& options) {
  check(scene);
  check_options(options);
  Int16Samples& samples = int16_samples(scene);
  const Lattice lattice = scene.lattice;
  const Universe universe = universe_on(lattice);
  options.progress.at(0.0);
  const Octree solid = octree_of_window(universe, scene, options.threshold, 32767.0);
  if (solid.is_empty())
    throw std::runtime_error(scene.source + ": no sample is at or above " +
                             std::to_string(options.threshold) + ": choose another threshold");
  options.progress.at(0.05);
  std::optional<Board> board;
  if (options.board_mm) board = board_of(scene, {options.threshold, *options.board_mm});
  const Octree without = board ? combine(universe, Expression(solid) - board->solid) : solid;
  const Octree patient = components(options.detach_mm ? open(without, *options.detach_mm) : without).largest;
  if (patient.is_empty())
    throw Error(ErrorCode::Geometry, scene.source + ": nothing is left after cutting links of " +
                                         std::to_string(options.detach_mm.value_or(0.0)) +
                                         " mm: choose a smaller radius");
  options.progress.at(0.3);
  const Octree rest = combine(universe, Expression(without) - patient);
  Octree foreign = foreign_parts(rest, patient, lattice, options);
  if (board) foreign = combine(universe, Expression(foreign) | board->solid);
  options.progress.at(0.7);
  const Octree body = combine(universe, Expression(solid) - foreign);
  Octree taken = foreign;
  if (!foreign.is_empty() && options.rim_mm > 0.0) {
    const Octree rim = dilate(foreign, options.rim_mm);
    options.progress.at(0.8);
    // The universe reaches beyond the scan's samples.
    const Octree samples_there = octree_of_window(universe, scene, -32768.0, 32767.0);
    taken = combine(universe,
                    ((Expression(rim) - dilate(body, options.rim_mm)) & samples_there) | Expression(foreign));
  }
  options.progress.at(0.9);
  HeadrestRemoval result{{}, kept_samples(taken, lattice, samples), foreign};
  result.parts = component_count(foreign);
  result.voxels = taken.voxel_count();
  result.solid_mm3 = static_cast<double>(foreign.voxel_count()) * lattice.voxel_mm3();
  for_each_voxel(taken, [&](const glm::ivec3& p) { samples[sample_index(lattice.dims, p)] = options.fill; });
  result.scene = std::move(scene);
  return result;
}

std::uint64_t restore(Scene& scene, const GreyOctree& removed) {
  check(scene);
  Int16Samples& samples = int16_samples(scene);
  const Lattice& lattice = scene.lattice;
  const Universe expected = universe_on(lattice);
  const Universe& universe = removed.universe();
  // Four points fix an affine map: the origin and the ends of the axes.
  double away = 0.0;
  for (int corner = 0; corner < 4; ++corner) {
    glm::dvec3 p(0.0);
    if (corner < 3) p[corner] = lattice.dims[corner];
    const glm::dvec3 there(universe.lps_from_voxel * glm::dvec4(p, 1.0));
    away = std::max(away, glm::distance(lattice.voxel(there), p));
  }
  if (universe.depth != expected.depth || !(away <= 1e-3))
    throw std::invalid_argument("the removed voxels are not of " + scene.source +
                                ": they belong to another scan, or this one was resampled since");
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
