// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Clusters of samples in the plane of density and gradient (thesis 2.3.4; Trivedi et al. 1986 after Panda and
// Rosenfeld, IEEE Trans. Computers 27, 1978). A sample at the border of two tissues has a density between
// theirs, which may be that of a third tissue. Its gradient is larger than inside the third tissue, so the
// sample gets another class.
namespace octotomy::voxel {

/// A cluster's middle: density in the scan's unit, and the length of the gradient in that unit per millimetre.
struct FeatureCentre {
  double density = 0.0, gradient = 0.0;
  double share = 0.0;  ///< the class's share of the scan's measured samples, 0 to 1
};

/// The classes in ascending order of density, and the standard deviation of each feature. Features are
/// divided by it to make them comparable.
struct FeatureClasses {
  std::vector<FeatureCentre> centres;
  double density_scale = 1.0, gradient_scale = 1.0;

  /// The index of the class whose middle is nearest to a sample; of equally near ones, the lowest.
  std::size_t nearest(double density, double gradient) const;
};

/// The magnitude of the gradient by central differences between neighbours, in sample units per millimetre.
/// Beyond the scene and in its padding the border samples repeat. Exact for linear fields on any lattice.
/// Throws InvalidInput for label maps; Stopped. Parallel, same bits on any thread count.
Scene gradient_length(const Scene& scene, const Progress& progress = {});

/// K-means clusters of the samples' densities and gradients, on a histogram of 256 by 256 bins between the
/// features' 0.1st and 99.9th percentiles, which also limit the weight of outliers. Starts with one cluster,
/// and splits the cluster of greatest variance at its middle, across the feature in which it varies most,
/// until there are `classes` clusters. After each split the means are iterated until no bin changes its
/// cluster. Edges between tissues form separate classes, one or two depending on their height, so three
/// tissues need five classes. Throws InvalidInput unless there are 2 to 8 classes, and as gradient_length()
/// does; Error (Geometry) if all samples or all gradients are equal, or fewer clusters exist; Stopped. Same
/// bits on any thread count.
FeatureClasses feature_classes(const Scene& scene, int classes, const Progress& progress = {});

/// A label map of each sample's class, numbered from 1; padding is 0. Throws as gradient_length().
Scene class_map(const Scene& scene, const FeatureClasses& classes, const Progress& progress = {});

}  // namespace octotomy::voxel
