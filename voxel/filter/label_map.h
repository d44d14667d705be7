// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"
#include "voxel/tree/octree.h"

// Scenes whose samples are the numbers of objects; 0 means no object.
namespace octotomy::voxel {

/// The smallest universe that contains the lattice's samples as its first voxels, with equal positions and
/// spacing. Throws std::length_error if this needs more than 2^Universe::max_depth voxels a side.
Universe universe_on(const Lattice& lattice);

/// Transfers an object from the voxels of a universe to the samples of a lattice. The object `made` was
/// chosen, opened, closed or filled from `base`; the two share one universe. `own` is the base computed
/// directly at the samples, on universe_on(lattice). If a sample and its nearest voxel are both in the base
/// or both outside it, the sample is in the object if that voxel is. Otherwise, the up to eight voxels around
/// the sample decide: a sample in the base is in the object if one of these voxels is, and a sample outside
/// the base is in the object if one of these voxels was added to the base. So a sample at a voxel's centre is
/// in the object exactly if the voxel is, and an unchanged base keeps exactly its samples. Parallel over
/// blocks.
Octree chosen_samples(const Lattice& lattice, const Octree& own, const Octree& base, const Octree& made);

/// The label map of objects on a lattice: a sample is i + 1 if objects[i] is the first object with a voxel at
/// its position. `overlaps` receives the number of samples that lie in several objects. Throws
/// std::invalid_argument for more than 32767 objects; Stopped. Parallel over slices.
struct LabelMap {
  Scene scene;
  std::uint64_t overlaps = 0;
};
LabelMap label_map(const Lattice& lattice, std::span<const Octree> objects, const Progress& progress = {});

/// The largest allowed label. Single precision represents every whole number up to this one, but may round
/// larger ones.
constexpr int most_label = (1 << 24) - 1;

/// The label that a sample stores: the whole number nearest to the sample. None if the sample differs from it
/// by more than a hundredth, or if the number is negative or above most_label. Scale factors and single
/// precision shift stored labels by less than a hundredth, interpolation between labels by more.
std::optional<int> label_of(double sample);

/// The labels of a scene except 0, ascending, with their numbers of samples; a sample with several labels is
/// counted for each of them (Scene::overlaps). Throws std::invalid_argument if label_of() returns none for a
/// sample.
struct Label {
  int number = 0;
  std::uint64_t samples = 0;
  double off = 0.0;  ///< largest difference between a sample of this label and the number
};
std::vector<Label> labels(const Scene& scene);

/// The same labels on another lattice, for a map that was cropped or has reversed or exchanged axes. None if
/// a sample of the scene lies between the lattice's samples, or if a sample with a label lies outside the
/// lattice.
std::optional<Scene> laid_on(const Scene& scene, const Lattice& lattice);

/// The object of the voxels whose nearest sample has the given label. Voxels outside the scan are not in the
/// object. Parallel over blocks.
Octree octree_of_label(const Universe& universe, const Scene& scene, int label);

/// A label map whose samples are int16 ranks: i + 1 for `labels[i]`. No two of its labels overlap.
struct LabelLayer {
  std::vector<int> labels;  ///< ascending
  Scene ranks;
};
/// The labels of a scene in few layers. Each label is put into the first layer in which it overlaps no other
/// label. Throws as labels() does; std::length_error for more than 32767 labels. Memory: two bytes per sample
/// and layer.
std::vector<LabelLayer> label_layers(const Scene& scene);

}  // namespace octotomy::voxel
