// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/filter/scale_space.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "voxel/filter/measured.h"
#include "voxel/filter/slice_work.h"
#include "voxel/filter/smooth.h"
#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::voxel {
namespace {

/// A number for each sample: the index of the sample to which it ascends, or the number of its region.
using Numbers = std::vector<std::uint32_t>;

/// The blurs' widths, from the coarsest down to about a voxel, then 0 for the scan itself.
std::vector<double> stack_of(double coarsest_mm, double voxel_mm) {
  std::vector<double> sigmas;
  // Narrower than half a voxel, a Gaussian does not change samples.
  for (double sigma = coarsest_mm; sigma >= 0.5 * voxel_mm; sigma /= std::numbers::sqrt2)
    sigmas.push_back(sigma);
  if (sigmas.empty()) sigmas.push_back(coarsest_mm);
  sigmas.push_back(0.0);
  return sigmas;
}

/// The rule for a sample without a higher neighbour. OneMaximum: it ascends to an equal neighbour of lower
/// index, so that a flat top is one maximum. EachItsOwn: it is a separate maximum.
enum class Flat { OneMaximum, EachItsOwn };

/// For each sample the index of the maximum to which it ascends.
Numbers ascended(const FloatSamples& samples, const glm::ivec3& dims, Flat flat, const Progress& progress) {
  Numbers next(samples.size());
  for_each_slice(dims.z, progress, [&](int z) {
    std::size_t at = sample_index(dims, {0, 0, z});
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x, ++at) {
        std::size_t highest = at;
        // Visits the neighbours in ascending order of index, so that the first of equally high neighbours is
        // chosen.
        for (int k = std::max(0, z - 1); k <= std::min(dims.z - 1, z + 1); ++k)
          for (int j = std::max(0, y - 1); j <= std::min(dims.y - 1, y + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(dims.x - 1, x + 1); ++i) {
              const std::size_t other = sample_index(dims, {i, j, k});
              if (samples[other] > samples[highest] ||
                  (flat == Flat::OneMaximum && samples[other] == samples[highest] && other < highest))
                highest = other;
            }
        next[at] = static_cast<std::uint32_t>(highest);
      }
  });
  // Each step leads to a higher sample, or to an equal sample of lower index, so every path ends. A path is
  // shortened while it is followed.
  for (std::size_t at = 0; at < next.size(); ++at) {
    std::uint32_t top = next[at];
    while (next[top] != top) top = next[top];
    for (std::uint32_t on = static_cast<std::uint32_t>(at); on != top;) on = std::exchange(next[on], top);
  }
  return next;
}

/// Numbers the regions in the window, the largest first; regions of equal size by their first samples.
Int16Samples ranked(const Numbers& region, const std::vector<bool>& is_inside,
                    std::vector<std::uint64_t>& sizes) {
  std::vector<std::uint64_t> count(region.size(), 0);
  std::vector<std::uint32_t> met;
  for (std::size_t at = 0; at < region.size(); ++at)
    if (is_inside[at] && count[region[at]]++ == 0) met.push_back(region[at]);
  if (met.empty()) throw Error(ErrorCode::Geometry, "no sample is in the window: choose another window");
  if (met.size() > 32767)
    throw Error(
        ErrorCode::Geometry,
        std::to_string(met.size()) + " regions are more than the 32767 of a label map: choose a wider blur");
  std::stable_sort(met.begin(), met.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return count[a] > count[b]; });
  std::vector<std::int16_t> rank(region.size(), 0);
  for (std::size_t i = 0; i < met.size(); ++i) {
    rank[met[i]] = static_cast<std::int16_t>(i + 1);
    sizes.push_back(count[met[i]]);
  }
  Int16Samples labels(region.size());
  for (std::size_t at = 0; at < region.size(); ++at)
    labels[at] = is_inside[at] ? rank[region[at]] : std::int16_t{0};
  return labels;
}

}  // namespace

ScaleSpace scale_space(const Scene& scene, const ScaleSpaceOptions& options) {
  check_values(scene, "a label map has no scale space");
  if (std::isnan(options.low) || std::isnan(options.high))
    throw InvalidInput("a bound of the window is not a number");
  if (!(options.sigma_mm > 0.0))
    throw InvalidInput("the coarsest blur must be wider than 0 mm, not " + std::to_string(options.sigma_mm));
  if (scene.lattice.sample_count() > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("the scan has more than 2^32 samples: crop it first");
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  std::vector<bool> is_inside(scene.lattice.sample_count());
  // Padding is filled for the blurs, and belongs to no region.
  Scene exact{scene.lattice, {}, Meaning::Raw, scene.modality, scene.source, {}};
  on_measured(scene, [&](const Scene& whole) {
    std::visit(
        [&](const auto& samples) {
          FloatSamples values(samples.begin(), samples.end());
          if (options.is_dark)
            for (float& value : values) value = -value;
          exact.samples = std::move(values);
        },
        whole.samples);
    return whole;
  });
  std::visit(
      [&](const auto& samples) {
        for (std::size_t at = 0; at < samples.size(); ++at) {
          const auto sample = static_cast<double>(samples[at]);
          is_inside[at] =
              sample >= options.low && sample <= options.high && !(scene.padding && sample == *scene.padding);
        }
      },
      scene.samples);
  ScaleSpace made;
  made.sigmas_mm = stack_of(options.sigma_mm, std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z}));
  Numbers region;
  for (std::size_t level = 0; level < made.sigmas_mm.size(); ++level) {
    const auto levels = static_cast<double>(made.sigmas_mm.size());
    const Progress here = part_of(options.progress, static_cast<double>(level) / levels,
                                  static_cast<double>(level + 1) / levels);
    const double sigma = made.sigmas_mm[level];
    const Scene blurred = sigma > 0.0 ? gaussian(exact, sigma, part_of(here, 0.0, 0.7)) : Scene{};
    const FloatSamples& samples = std::get<FloatSamples>(sigma > 0.0 ? blurred.samples : exact.samples);
    Numbers top =
        ascended(samples, dims, level == 0 ? Flat::OneMaximum : Flat::EachItsOwn, part_of(here, 0.7, 1.0));
    std::size_t maxima = 0;
    for (std::size_t at = 0; at < top.size(); ++at) maxima += top[at] == at ? 1 : 0;
    made.maxima.push_back(maxima);
    // A maximum of this level belongs to the region of the coarser level at the same sample.
    if (!region.empty())
      for (std::uint32_t& number : top) number = region[number];
    region = std::move(top);
  }
  made.labels = empty_scene_like(scene, scene.lattice);
  made.labels.meaning = Meaning::Label;
  made.labels.padding.reset();
  made.labels.samples = ranked(region, is_inside, made.samples);
  return made;
}

}  // namespace octotomy::voxel
