// SPDX-License-Identifier: AGPL-3.0-or-later
//
// Only this unit and bias_field.cpp include ITK's filters. They read the scene's own samples. Local filters
// run slab by slab along z, so that a slab bounds the extra memory and the delay of a stop, and ITK need not
// report progress from its threads.
#include "voxel/filter/smooth.h"

#include "voxel/space/itk_compiler.h"

#include <algorithm>
#include <cmath>
#include <itkCommand.h>
#include <itkDiscreteGaussianImageFilter.h>
#include <itkGradientAnisotropicDiffusionImageFilter.h>
#include <itkImage.h>
#include <itkMedianImageFilter.h>
#include <stdexcept>
#include <string>
#include <tbb/task_arena.h>

#include "voxel/filter/measured.h"
#include "voxel/filter/slice_work.h"
#include "voxel/space/error.h"
#include "voxel/space/rounded.h"

namespace octotomy::voxel {
namespace {

template <typename Sample>
using Image = itk::Image<Sample, 3>;

// An ITK image of the slices from `from` up to, not including, `to`. It refers to the samples without copying
// them.
template <typename Sample>
typename Image<Sample>::Pointer image_of(const Sample* samples, const Lattice& lattice, int from, int to) {
  auto image = Image<Sample>::New();
  typename Image<Sample>::RegionType region;
  region.SetSize({static_cast<itk::SizeValueType>(lattice.dims.x),
                  static_cast<itk::SizeValueType>(lattice.dims.y),
                  static_cast<itk::SizeValueType>(to - from)});
  image->SetRegions(region);
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  const double spacing[3]{spacing_mm.x, spacing_mm.y, spacing_mm.z};
  image->SetSpacing(spacing);
  const std::size_t count = slice_size(lattice) * static_cast<std::size_t>(to - from);
  // The container requires a mutable pointer, which it does not own. No filter here runs in place, so none
  // writes to the samples.
  image->GetPixelContainer()->SetImportPointer(
      const_cast<Sample*>(samples) + slice_size(lattice) * static_cast<std::size_t>(from), count, false);
  return image;
}

template <typename Filter>
void set_threads(Filter& filter) {
  filter.SetNumberOfWorkUnits(static_cast<itk::ThreadIdType>(tbb::this_task_arena::max_concurrency()));
}

// Calls smooth(from, to, first, last) for slabs of slices [first, last), which depend on the slices [from,
// to), up to `reach` more at either end.
template <typename Smooth>
void slab_by_slab(int slices, int reach, const Progress& progress, const Smooth& smooth) {
  // Slabs are thick so that the overlap is a small part of the work.
  const int thickness = std::max(16, 4 * reach);
  for (int first = 0; first < slices; first += thickness) {
    progress.at(static_cast<double>(first) / slices);
    const int last = std::min(first + thickness, slices);
    smooth(std::max(0, first - reach), std::min(slices, last + reach), first, last);
  }
}

template <typename Sample, typename Out, typename Held>
void take_slab(const Image<Out>& image, const Lattice& lattice, int from, int first, int last, Held& out) {
  const std::size_t size = slice_size(lattice);
  const Out* const made = image.GetBufferPointer() + size * static_cast<std::size_t>(first - from);
  std::transform(made, made + size * static_cast<std::size_t>(last - first),
                 out.begin() + static_cast<std::ptrdiff_t>(size * static_cast<std::size_t>(first)),
                 [](Out value) {
                   if constexpr (std::is_same_v<Out, Sample>)
                     return value;
                   else
                     return rounded<Sample>(static_cast<double>(value));
                 });
}

// Runs a local filter slab by slab. new_filter(Sample()) makes a filter whose slices depend on at most
// `reach` slices on either side.
template <typename NewFilter>
Scene filtered(const Scene& scene, int reach, const Progress& progress, const NewFilter& new_filter) {
  Scene result = empty_scene_like(scene, scene.lattice);
  const Lattice& lattice = scene.lattice;
  std::visit(
      [&](const auto& samples) {
        using Sample = typename std::decay_t<decltype(samples)>::value_type;
        Samples<Sample> made(samples.size());
        slab_by_slab(lattice.dims.z, reach, progress, [&](int from, int to, int first, int last) {
          const auto filter = new_filter(Sample());
          set_threads(*filter);
          filter->SetInput(image_of(samples.data(), lattice, from, to));
          filter->Update();
          take_slab<Sample>(*filter->GetOutput(), lattice, from, first, last, made);
        });
        result.samples = std::move(made);
      },
      scene.samples);
  return result;
}

[[noreturn]] void refuse(const std::string& what) {
  throw InvalidInput(what);
}

}  // namespace

Scene median(const Scene& scene, const glm::ivec3& radius, const Progress& progress) {
  check_values(scene, "a label map cannot be smoothed");
  if (glm::any(glm::lessThan(radius, glm::ivec3(0))) || glm::any(glm::greaterThan(radius, glm::ivec3(16))))
    refuse("a median's radius must be 0 to 16 samples along each axis");
  if (scene.padding)
    return on_measured(scene, [&](const Scene& whole) { return median(whole, radius, progress); });
  return filtered(scene, radius.z, progress, [&]<typename Sample>(Sample /*tag*/) {
    auto filter = itk::MedianImageFilter<Image<Sample>, Image<Sample>>::New();
    filter->SetRadius({static_cast<itk::SizeValueType>(radius.x), static_cast<itk::SizeValueType>(radius.y),
                       static_cast<itk::SizeValueType>(radius.z)});
    return filter;
  });
}

Scene gaussian(const Scene& scene, double sigma_mm, const Progress& progress) {
  check_values(scene, "a label map cannot be smoothed");
  const glm::dvec3 spacing_mm = scene.lattice.spacing_mm();
  const double finest_mm = std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  if (!(sigma_mm > 0.0) || !(sigma_mm <= 32.0 * finest_mm))
    refuse("a Gaussian's sigma must be above 0 and at most 32 samples, " + rounded(32.0 * finest_mm) +
           " mm here, not " + rounded(sigma_mm) + " mm");
  if (scene.padding)
    return on_measured(scene, [&](const Scene& whole) { return gaussian(whole, sigma_mm, progress); });
  // ITK cuts the weights off at less than four standard deviations plus two samples.
  const int reach = static_cast<int>(std::ceil(4.0 * sigma_mm / spacing_mm.z)) + 2;
  return filtered(scene, reach, progress, [&]<typename Sample>(Sample /*tag*/) {
    auto filter = itk::DiscreteGaussianImageFilter<Image<Sample>, Image<float>>::New();
    filter->SetVariance(sigma_mm * sigma_mm);
    filter->SetMaximumError(0.001);
    filter->SetMaximumKernelWidth(2 * 4 * 32 + 5);
    filter->SetUseImageSpacing(true);
    return filter;
  });
}

Scene diffuse(const Scene& scene, const DiffusionOptions& options) {
  check_values(scene, "a label map cannot be smoothed");
  if (options.iterations < 1 || options.iterations > 1000)
    refuse("the number of iterations of the diffusion must be from 1 to 1000, not " +
           std::to_string(options.iterations));
  if (!(options.conductance > 0.0) || !std::isfinite(options.conductance))
    refuse("the conductance of the diffusion must be positive, not " + std::to_string(options.conductance));
  if (scene.padding) return on_measured(scene, [&](const Scene& whole) { return diffuse(whole, options); });
  options.progress.at(0.0);
  Scene result = empty_scene_like(scene, scene.lattice);
  const Lattice& lattice = scene.lattice;
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  // Processes the whole scan at once, because the conductance is relative to the gradient of the whole scan.
  std::visit(
      [&](const auto& samples) {
        using Sample = typename std::decay_t<decltype(samples)>::value_type;
        auto filter = itk::GradientAnisotropicDiffusionImageFilter<Image<Sample>, Image<float>>::New();
        set_threads(*filter);
        filter->SetNumberOfIterations(static_cast<itk::IdentifierType>(options.iterations));
        filter->SetConductanceParameter(options.conductance);
        // The longest step that is stable in three dimensions: the smallest spacing over 2^(3 + 1).
        filter->SetTimeStep(std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z}) / 16.0);
        filter->SetInput(image_of(samples.data(), lattice, 0, lattice.dims.z));
        // ITK calls this function between iterations, in the calling thread, and lets its exceptions pass.
        filter->AddObserver(itk::IterationEvent(), [&, done = 0](const itk::EventObject&) mutable {
          options.progress.at(static_cast<double>(++done) / (options.iterations + 1));
        });
        filter->Update();
        Samples<Sample> made(samples.size());
        take_slab<Sample>(*filter->GetOutput(), lattice, 0, 0, lattice.dims.z, made);
        result.samples = std::move(made);
      },
      scene.samples);
  return result;
}

}  // namespace octotomy::voxel
