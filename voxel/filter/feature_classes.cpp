// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/feature_classes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "voxel/filter/histogram.h"
#include "voxel/filter/measured.h"
#include "voxel/filter/slice_work.h"
#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::voxel {
namespace {

constexpr int bins = 256;

/// A bin that contains samples: its scaled features, and the number of its samples.
struct Bin {
  glm::dvec2 place{0.0};
  double weight = 0.0;
  std::size_t cluster = 0;
};

/// The bins' mean, weight and variance along each feature.
struct Cluster {
  glm::dvec2 mean{0.0}, variance{0.0};
  double weight = 0.0;
};

std::vector<Cluster> clusters_of(const std::vector<Bin>& all, std::size_t count) {
  std::vector<Cluster> clusters(count);
  for (const Bin& bin : all) {
    clusters[bin.cluster].weight += bin.weight;
    clusters[bin.cluster].mean += bin.weight * bin.place;
  }
  for (Cluster& cluster : clusters)
    if (cluster.weight > 0.0) cluster.mean /= cluster.weight;
  for (const Bin& bin : all) {
    const glm::dvec2 off = bin.place - clusters[bin.cluster].mean;
    // If `weighted` is set, the variance is the sum of squares instead of their mean.
    clusters[bin.cluster].variance += bin.weight * off * off;
  }
  return clusters;
}

std::size_t nearest_of(const std::vector<Cluster>& clusters, const glm::dvec2& place) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const glm::dvec2 off = place - clusters[i].mean;
    const double square = glm::dot(off, off);
    if (square >= least) continue;
    least = square;
    nearest = i;
  }
  return nearest;
}

/// Iterates the means until no bin changes its cluster. The sum of squares falls with every change, so the
/// iteration ends; the bound on rounds guards against rounding errors.
void settle(std::vector<Bin>& all, std::size_t count, const Progress& progress) {
  for (int round = 0; round < 10000; ++round) {
    progress.at(0.0);
    const std::vector<Cluster> clusters = clusters_of(all, count);
    bool is_changed = false;
    for (Bin& bin : all) {
      const std::size_t nearest = nearest_of(clusters, bin.place);
      is_changed = is_changed || nearest != bin.cluster;
      bin.cluster = nearest;
    }
    if (!is_changed) return;
  }
}

/// Splits the cluster with the greatest variance at its middle, along the feature in which it varies most.
void split(std::vector<Bin>& all, std::size_t count) {
  const std::vector<Cluster> clusters = clusters_of(all, count);
  std::size_t widest = 0;
  for (std::size_t i = 1; i < count; ++i)
    if (clusters[i].variance.x + clusters[i].variance.y >
        clusters[widest].variance.x + clusters[widest].variance.y)
      widest = i;
  const Cluster& cluster = clusters[widest];
  const int feature = cluster.variance.y > cluster.variance.x ? 1 : 0;
  for (Bin& bin : all)
    if (bin.cluster == widest && bin.place[feature] > cluster.mean[feature]) bin.cluster = count;
}

/// The number of the bin that contains a value.
int bin_of(double value, const Histogram& along) {
  return static_cast<int>(std::floor(std::clamp((value - along.low) / along.width(), 0.0, bins - 1.0) + 0.5));
}

/// The number of samples in each pair of bins, the density's bin fastest, then the gradient's.
std::vector<std::uint64_t> joint_histogram(const Scene& scene, const Scene& gradient,
                                           const Histogram& densities, const Histogram& gradients) {
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(bins) * bins, 0);
  const auto& lengths = std::get<FloatSamples>(gradient.samples);
  std::visit(
      [&](const auto& samples) {
        for (std::size_t i = 0; i < samples.size(); ++i) {
          const auto sample = static_cast<double>(samples[i]);
          if ((scene.padding && sample == *scene.padding) || std::isnan(sample)) continue;
          const int x = bin_of(sample, densities), y = bin_of(static_cast<double>(lengths[i]), gradients);
          ++counts[static_cast<std::size_t>(x + bins * y)];
        }
      },
      scene.samples);
  return counts;
}

}  // namespace

std::size_t FeatureClasses::nearest(double density, double gradient) const {
  std::size_t found = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const double x = (density - centres[i].density) / density_scale;
    const double y = (gradient - centres[i].gradient) / gradient_scale;
    const double square = x * x + y * y;
    if (square >= least) continue;
    least = square;
    found = i;
  }
  return found;
}

Scene gradient_length(const Scene& scene, const Progress& progress) {
  check_values(scene, "a label map has no gradient");
  if (scene.padding)
    return on_measured(scene, [&](const Scene& whole) { return gradient_length(whole, progress); });
  const glm::dmat3 mm_from_index = glm::transpose(glm::inverse(glm::dmat3(scene.lattice.lps_from_voxel)));
  const glm::ivec3 dims = scene.lattice.dims;
  Scene result = empty_scene_like(scene, scene.lattice);
  result.meaning = Meaning::Raw;
  FloatSamples lengths(scene.lattice.sample_count());
  std::visit(
      [&](const auto& samples) {
        for_each_slice(dims.z, progress, [&](int z) {
          std::size_t at = sample_index(dims, {0, 0, z});
          for (int y = 0; y < dims.y; ++y)
            for (int x = 0; x < dims.x; ++x, ++at) {
              glm::dvec3 slope(0.0);
              for (int axis = 0; axis < 3; ++axis) {
                glm::ivec3 before(x, y, z), after(x, y, z);
                before[axis] = std::max(0, before[axis] - 1);
                after[axis] = std::min(dims[axis] - 1, after[axis] + 1);
                slope[axis] = 0.5 * (static_cast<double>(samples[sample_index(dims, after)]) -
                                     static_cast<double>(samples[sample_index(dims, before)]));
              }
              lengths[at] = static_cast<float>(glm::length(mm_from_index * slope));
            }
        });
      },
      scene.samples);
  result.samples = std::move(lengths);
  return result;
}

FeatureClasses feature_classes(const Scene& scene, int classes, const Progress& progress) {
  if (classes < 2 || classes > 8)
    throw InvalidInput("the number of classes must be from 2 to 8, not " + std::to_string(classes));
  const Scene gradient = gradient_length(scene, part_of(progress, 0.0, 0.5));
  const Histogram densities = histogram(scene, bins), gradients = histogram(gradient, bins);
  const std::vector<std::uint64_t> counts = joint_histogram(scene, gradient, densities, gradients);
  std::vector<Bin> all;
  for (int y = 0; y < bins; ++y)
    for (int x = 0; x < bins; ++x)
      if (const std::uint64_t count = counts[static_cast<std::size_t>(x + bins * y)]; count > 0)
        all.push_back({{densities.low + x * densities.width(), gradients.low + y * gradients.width()},
                       static_cast<double>(count)});
  const Cluster whole = clusters_of(all, 1).front();
  FeatureClasses made;
  made.density_scale = std::sqrt(whole.variance.x / whole.weight);
  made.gradient_scale = std::sqrt(whole.variance.y / whole.weight);
  if (!(made.density_scale > 0.0) || !(made.gradient_scale > 0.0))
    throw Error(ErrorCode::Geometry,
                "all samples have one density or one gradient, so they cannot be divided into classes");
  const glm::dvec2 scale(made.density_scale, made.gradient_scale);
  for (Bin& bin : all) bin.place /= scale;
  const auto wanted = static_cast<std::size_t>(classes);
  for (std::size_t count = 1; count < wanted; ++count) {
    split(all, count);
    settle(all, count + 1, part_of(progress, 0.5, 1.0));
  }
  for (const Cluster& cluster : clusters_of(all, wanted)) {
    if (!(cluster.weight > 0.0))
      throw Error(ErrorCode::Geometry, "the samples have fewer than " + std::to_string(classes) +
                                           " clusters of density and gradient: choose fewer classes");
    made.centres.push_back(
        {cluster.mean.x * scale.x, cluster.mean.y * scale.y, cluster.weight / whole.weight});
  }
  std::sort(made.centres.begin(), made.centres.end(), [](const FeatureCentre& a, const FeatureCentre& b) {
    return std::pair(a.density, a.gradient) < std::pair(b.density, b.gradient);
  });
  return made;
}

Scene class_map(const Scene& scene, const FeatureClasses& classes, const Progress& progress) {
  const Scene gradient = gradient_length(scene, part_of(progress, 0.0, 0.7));
  const auto& lengths = std::get<FloatSamples>(gradient.samples);
  const glm::ivec3 dims = scene.lattice.dims;
  Scene result = empty_scene_like(scene, scene.lattice);
  result.meaning = Meaning::Label;
  result.padding.reset();
  Int16Samples numbers(scene.lattice.sample_count());
  std::visit(
      [&](const auto& samples) {
        for_each_slice(dims.z, part_of(progress, 0.7, 1.0), [&](int z) {
          const std::size_t from = sample_index(dims, {0, 0, z});
          for (std::size_t i = from; i < from + slice_size(scene.lattice); ++i) {
            const auto sample = static_cast<double>(samples[i]);
            if ((scene.padding && sample == *scene.padding) || std::isnan(sample)) continue;
            numbers[i] =
                static_cast<std::int16_t>(1 + classes.nearest(sample, static_cast<double>(lengths[i])));
          }
        });
      },
      scene.samples);
  result.samples = std::move(numbers);
  return result;
}

}  // namespace octotomy::voxel
