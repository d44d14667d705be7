// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/trace_contours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tbb/parallel_for.h>
#include <utility>

#include "voxel/space/error.h"
#include "voxel/space/shared_progress.h"

namespace octotomy::convert {
namespace {

/// The depth of a sample within the window, negative outside, clamped for float. Contours run at depth zero.
/// An infinite bound excludes nothing.
float depth_in(double sample, double low, double high) {
  constexpr double most = 1e30;
  if (std::isnan(sample)) return static_cast<float>(-most);
  return static_cast<float>(std::clamp(std::min(sample - low, high - sample), -most, most));
}

}  // namespace

std::vector<brep::Section> trace_contours(const voxel::Scene& scene, double low, double high,
                                          const voxel::Progress& progress) {
  voxel::check(scene);
  if (std::isnan(low) || std::isnan(high))
    throw voxel::InvalidInput("trace_contours: a bound of the window is not a number");
  const glm::dvec3 spacing = scene.lattice.spacing_mm();
  const auto width = static_cast<std::uint32_t>(scene.lattice.dims.x);
  const auto height = static_cast<std::uint32_t>(scene.lattice.dims.y);
  const std::size_t area = std::size_t{width} * height;
  std::vector<brep::Section> sections(static_cast<std::size_t>(scene.lattice.dims.z));
  voxel::SharedProgress slices_done(progress, sections.size());
  tbb::parallel_for(std::size_t{0}, sections.size(), [&](std::size_t k) {
    slices_done.one_more();
    std::vector<float> depth(area);
    std::visit(
        [&](const auto& samples) {
          for (std::size_t s = 0; s < area; ++s)
            depth[s] = depth_in(static_cast<double>(samples[k * area + s]), low, high);
        },
        scene.samples);
    sections[k].z_mm = static_cast<double>(k) * spacing.z;
    sections[k].contours = brep::follow({depth, width, height, {spacing.x, spacing.y}}, {.threshold = 0.0});
  });
  return sections;
}

brep::TiledSections contour_surface(const voxel::Scene& scene, double low, double high,
                                    const brep::TileSectionsOptions& options,
                                    const voxel::Progress& progress) {
  brep::TiledSections tiled =
      brep::tile_sections(trace_contours(scene, low, high, voxel::part_of(progress, 0.0, 0.5)), options);
  progress.at(1.0);
  const glm::dvec3 spacing = scene.lattice.spacing_mm();
  for (glm::dvec3& p : tiled.surface.points_mm) p = scene.lattice.lps_mm(p / spacing);
  // A mirrored lattice reverses the triangles.
  if (glm::determinant(glm::dmat3(scene.lattice.lps_from_voxel)) < 0.0)
    for (auto& face : tiled.surface.faces) std::swap(face[1], face[2]);
  return tiled;
}

}  // namespace octotomy::convert
