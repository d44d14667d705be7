// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1. The scan is thinned to one sample in every few, because the field changes over centimetres. Samples are
//    not averaged, which would mix tissues and blur the histogram that N4 sharpens.
// 2. ITK's N4 fits the logarithm of the field to the thinned samples above the threshold.
// 3. The spline of the last level is evaluated at the scan's own samples, slice by slice in parallel.
#include "voxel/filter/bias_field.h"

#include "voxel/space/itk_compiler.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <itkCommand.h>
#include <itkImage.h>
#include <itkMultiThreaderBase.h>
#include <itkN4BiasFieldCorrectionImageFilter.h>
#include <limits>
#include <mutex>
#include <string>
#include <vector>

#include "voxel/filter/histogram.h"
#include "voxel/filter/otsu.h"
#include "voxel/filter/slice_work.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::voxel {
namespace {

using Values = itk::Image<float, 3>;
using Mask = itk::Image<unsigned char, 3>;
using N4 = itk::N4BiasFieldCorrectionImageFilter<Values, Mask, Values>;
constexpr int order = 3;  // of the spline

[[noreturn]] void refuse(const std::string& what) {
  throw InvalidInput(what);
}

void check_options(const Scene& scene, const BiasFieldOptions& options) {
  check_values(scene, "a label map has no magnetic field to correct: choose an MR scan");
  if (scene.meaning == Meaning::Hounsfield)
    refuse("a CT in Hounsfield units has no magnetic field to correct: choose an MR scan");
  if (options.threshold && (!(*options.threshold >= 0.0) || !std::isfinite(*options.threshold)))
    refuse("the threshold must be at least 0, because the field multiplies samples, not " +
           std::to_string(*options.threshold));
  if (!(options.knots_mm > 0.0) || !std::isfinite(options.knots_mm))
    refuse("the distance between knots must be above 0 mm, not " + std::to_string(options.knots_mm));
  if (options.levels < 1 || options.levels > 6)
    refuse("the number of levels of the fit must be from 1 to 6, not " + std::to_string(options.levels));
  if (options.iterations < 1 || options.iterations > 1000)
    refuse("the number of iterations in a level must be from 1 to 1000, not " +
           std::to_string(options.iterations));
  if (!(options.noise > 0.0) || !std::isfinite(options.noise))
    refuse("the noise of the filter must be above 0, not " + std::to_string(options.noise));
}

// N4's inner filters use ITK's default number of threads, on which the fit's sums depend. While this object
// exists, the default is 1. Other filters of this program set their number of threads explicitly.
class OneThread {
 public:
  OneThread() : lock_(mutex()), before_(itk::MultiThreaderBase::GetGlobalDefaultNumberOfThreads()) {
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(1);
  }
  ~OneThread() { itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::lock_guard<std::mutex> lock_;
  itk::ThreadIdType before_;
};

// The logarithm of the field as a uniform cubic B-spline. Positions are in samples of the thinned scan.
class Spline {
 public:
  Spline(const N4::BiasFieldControlPointLatticeType& lattice, const glm::ivec3& dims) {
    const auto size = lattice.GetLargestPossibleRegion().GetSize();
    for (int axis = 0; axis < 3; ++axis) {
      count_[axis] = static_cast<int>(size[static_cast<unsigned>(axis)]);
      per_sample_[axis] = dims[axis] > 1 ? (count_[axis] - order) / static_cast<double>(dims[axis] - 1) : 0.0;
    }
    const auto* points = lattice.GetBufferPointer();
    points_.resize(lattice.GetLargestPossibleRegion().GetNumberOfPixels());
    for (std::size_t i = 0; i < points_.size(); ++i) points_[i] = static_cast<double>(points[i][0]);
  }

  double operator()(const glm::dvec3& position) const {
    std::array<std::array<double, order + 1>, 3> weights{};
    glm::ivec3 first(0);
    for (int axis = 0; axis < 3; ++axis) {
      const double spans = count_[axis] - order;
      const double t = std::clamp(position[axis] * per_sample_[axis], 0.0, spans);
      first[axis] = std::min(static_cast<int>(t), count_[axis] - order - 1);
      weights[static_cast<std::size_t>(axis)] = weights_at(t - first[axis]);
    }
    double sum = 0.0;
    for (int z = 0; z <= order; ++z)
      for (int y = 0; y <= order; ++y) {
        double row = 0.0;
        for (int x = 0; x <= order; ++x)
          row += weights[0][static_cast<std::size_t>(x)] *
                 points_[sample_index(count_, first + glm::ivec3(x, y, z))];
        sum += weights[1][static_cast<std::size_t>(y)] * weights[2][static_cast<std::size_t>(z)] * row;
      }
    return sum;
  }

 private:
  static std::array<double, order + 1> weights_at(double t) {
    const double s = 1.0 - t;
    return {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
            (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
  }

  glm::ivec3 count_{0};
  glm::dvec3 per_sample_{0.0};
  std::vector<double> points_;
};

// A regular grid selected from the scan's samples, with marks for the samples that determine the field.
struct Thinned {
  Lattice lattice;
  FloatSamples values;
  std::vector<unsigned char> chosen;
  std::size_t count = 0;
};

Thinned thinned(const Scene& scene, const glm::ivec3& every, const glm::ivec3& first, double threshold) {
  Thinned thin;
  thin.lattice = scene.lattice;
  thin.lattice.dims = (scene.lattice.dims - 1 - first) / every + 1;
  for (int axis = 0; axis < 3; ++axis) thin.lattice.lps_from_voxel[axis] *= static_cast<double>(every[axis]);
  thin.lattice.lps_from_voxel[3] = glm::dvec4(scene.lattice.lps_mm(glm::dvec3(first)), 1.0);
  const glm::ivec3 dims = thin.lattice.dims;
  std::visit(
      [&](const auto& samples) {
        for (int z = 0; z < dims.z; ++z)
          for (int y = 0; y < dims.y; ++y)
            for (int x = 0; x < dims.x; ++x) {
              const auto value = static_cast<double>(
                  samples[sample_index(scene.lattice.dims, first + every * glm::ivec3(x, y, z))]);
              const bool is_measured = std::isfinite(value) && !(scene.padding && value == *scene.padding);
              const bool is_chosen = is_measured && value > threshold;
              thin.values.push_back(is_measured ? static_cast<float>(value) : 0.0F);
              thin.chosen.push_back(is_chosen ? 1 : 0);
              thin.count += is_chosen ? 1 : 0;
            }
      },
      scene.samples);
  if (thin.count < 100)
    throw Error(ErrorCode::Geometry,
                "only " + std::to_string(thin.count) + " of the thinned samples are above the threshold of " +
                    rounded(threshold) + ": choose a lower threshold, or a scan with more samples above 0");
  return thin;
}

template <typename Image, typename Sample>
typename Image::Pointer image_on(Sample* samples, const Lattice& lattice) {
  auto image = Image::New();
  typename Image::RegionType region;
  const glm::ivec3 dims = lattice.dims;
  region.SetSize({static_cast<itk::SizeValueType>(dims.x), static_cast<itk::SizeValueType>(dims.y),
                  static_cast<itk::SizeValueType>(dims.z)});
  image->SetRegions(region);
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  const double spacing[3]{spacing_mm.x, spacing_mm.y, spacing_mm.z};
  image->SetSpacing(spacing);
  image->GetPixelContainer()->SetImportPointer(samples, lattice.sample_count(), false);
  return image;
}

Spline fitted(Thinned& thin, const BiasFieldOptions& options) {
  const Lattice& lattice = thin.lattice;
  const OneThread one;
  auto filter = N4::New();
  filter->SetNumberOfWorkUnits(1);
  filter->SetInput(image_on<Values>(thin.values.data(), lattice));
  filter->SetMaskImage(image_on<Mask>(thin.chosen.data(), lattice));
  filter->SetUseMaskLabel(false);
  N4::ArrayType points, levels;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int along = static_cast<int>(axis);
    const double length_mm = lattice.dims[along] * lattice.spacing_mm()[along];
    points[axis] = static_cast<unsigned>(std::max(1.0, std::ceil(length_mm / options.knots_mm))) + order;
    levels[axis] = static_cast<unsigned>(options.levels);
  }
  filter->SetNumberOfControlPoints(points);
  filter->SetNumberOfFittingLevels(levels);
  N4::VariableSizeArrayType iterations(static_cast<unsigned>(options.levels));
  iterations.Fill(static_cast<unsigned>(options.iterations));
  filter->SetMaximumNumberOfIterations(iterations);
  filter->SetConvergenceThreshold(1e-3);
  filter->SetWienerFilterNoise(options.noise);
  const double most = options.levels * options.iterations;
  filter->AddObserver(itk::IterationEvent(), [&, done = 0](const itk::EventObject&) mutable {
    options.progress.at(0.1 + 0.7 * std::min(1.0, ++done / most));
  });
  filter->Update();
  return {*filter->GetLogBiasFieldControlPointLattice(), lattice.dims};
}

}  // namespace

BiasCorrection correct_bias_field(const Scene& scene, const BiasFieldOptions& options) {
  check_options(scene, options);
  options.progress.at(0.0);
  BiasCorrection made;
  made.threshold =
      options.threshold ? *options.threshold : std::max(0.0, otsu_thresholds(histogram(scene), 2).front());
  // The thinned scan has four samples between the finest knots, which determine the spline. Its spacing is at
  // most 8 mm, because a wider one misses thin tissues. A small scan keeps 16 samples along each axis.
  const double apart_mm = std::min(8.0, options.knots_mm / std::ldexp(4.0, options.levels - 1));
  const glm::ivec3 dims = scene.lattice.dims;
  glm::ivec3 every(1);
  for (int axis = 0; axis < 3; ++axis)
    every[axis] = std::clamp(static_cast<int>(std::lround(apart_mm / scene.lattice.spacing_mm()[axis])), 1,
                             std::max(1, dims[axis] / 16));
  const glm::ivec3 first = (every - 1) / 2;
  Thinned thin = thinned(scene, every, first, made.threshold);
  made.fitted = thin.count;
  options.progress.at(0.1);
  const Spline spline = fitted(thin, options);
  const glm::ivec3 coarse = thin.lattice.dims;
  double sum = 0.0, low = std::numeric_limits<double>::infinity(), high = -low;
  std::size_t at = 0;
  for (int z = 0; z < coarse.z; ++z)
    for (int y = 0; y < coarse.y; ++y)
      for (int x = 0; x < coarse.x; ++x, ++at) {
        if (thin.chosen[at] == 0) continue;
        const double value = spline({x, y, z});
        sum += value;
        low = std::min(low, value);
        high = std::max(high, value);
      }
  const double mean = sum / static_cast<double>(thin.count);
  made.field_low = std::exp(low - mean);
  made.field_high = std::exp(high - mean);
  made.scene = empty_scene_like(scene, scene.lattice);
  std::visit(
      [&](const auto& samples) {
        FloatSamples corrected(samples.size());
        std::atomic<bool> is_too_large = false;
        for_each_slice(dims.z, part_of(options.progress, 0.8, 1.0), [&](int z) {
          std::size_t i = sample_index(dims, {0, 0, z});
          for (int y = 0; y < dims.y; ++y)
            for (int x = 0; x < dims.x; ++x, ++i) {
              const auto sample = static_cast<double>(samples[i]);
              if (scene.padding && sample == *scene.padding) {
                corrected[i] = static_cast<float>(sample);
                continue;
              }
              const glm::dvec3 position = glm::dvec3(glm::ivec3(x, y, z) - first) / glm::dvec3(every);
              corrected[i] = static_cast<float>(sample / std::exp(spline(position) - mean));
              if (!std::isfinite(corrected[i])) is_too_large = true;
            }
        });
        if (is_too_large)
          throw Error(
              ErrorCode::Geometry,
              "some samples are too large to be corrected: scale the scan down, or crop it to the patient");
        made.scene.samples = std::move(corrected);
      },
      scene.samples);
  return made;
}

}  // namespace octotomy::voxel
