// SPDX-License-Identifier: AGPL-3.0-or-later
#include "voxel/space/scene.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "voxel/space/error.h"

namespace octotomy::voxel {

Range range(const Scene& scene) {
  assert(scene.lattice.sample_count() > 0);
  return std::visit(
      [&](const auto& samples) {
        if (!scene.padding) {
          const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
          return Range{static_cast<double>(*low), static_cast<double>(*high)};
        }
        Range found{std::numeric_limits<double>::infinity(), *scene.padding};
        for (const auto sample : samples) {
          const auto value = static_cast<double>(sample);
          if (value == *scene.padding) continue;
          found.low = std::min(found.low, value);
          found.high = std::max(found.high, value);
        }
        found.low = std::min(found.low, found.high);
        return found;
      },
      scene.samples);
}

double above_padding(const Scene& scene, double low) {
  if (!scene.padding || low > *scene.padding) return low;
  return std::nextafter(*scene.padding, std::numeric_limits<double>::infinity());
}

std::string unit(const Scene& scene) {
  return scene.meaning == Meaning::Hounsfield ? "HU" : "1";
}

std::optional<SliceRange> slices_inside(const Lattice& lattice, const Hole& hole) {
  const glm::dvec3 step_mm(lattice.lps_from_voxel[2]);
  const double along_mm = glm::dot(step_mm, hole.normal);
  // The limit is the cosine of 0.8 degrees. If the slices of a lattice are tilted against the slab by more
  // than this angle, none of them lies wholly inside the slab.
  if (!(std::abs(along_mm) > 0.9999 * glm::length(step_mm))) return std::nullopt;
  const double start_mm = glm::dot(glm::dvec3(lattice.lps_from_voxel[3]), hole.normal);
  // A slice within a hundredth of a step from an image counts as this image, which was measured.
  double low = (hole.low_mm - start_mm) / along_mm, high = (hole.high_mm - start_mm) / along_mm;
  if (low > high) std::swap(low, high);
  const double first = std::max(std::floor(low + 0.01) + 1.0, 0.0);
  const double last = std::min(std::ceil(high - 0.01) - 1.0, lattice.dims.z - 1.0);
  if (!(first <= last)) return std::nullopt;
  return SliceRange{static_cast<int>(first), static_cast<int>(last)};
}

void check(const Scene& scene) {
  const Lattice& lattice = scene.lattice;
  if (lattice.dims.x < 1 || lattice.dims.y < 1 || lattice.dims.z < 1)
    throw InvalidInput(scene.source + ": the scene has no samples");
  const std::size_t held = std::visit([](const auto& samples) { return samples.size(); }, scene.samples);
  if (held != lattice.sample_count())
    throw InvalidInput(scene.source + ": " + std::to_string(held) + " samples where the lattice has " +
                       std::to_string(lattice.sample_count()));
  const double volume = lattice.voxel_mm3();
  if (!std::isfinite(volume) || volume <= 0.0)
    throw InvalidInput(scene.source + ": the lattice's axes span no volume");
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(lattice.lps_from_voxel[column][row]))
        throw InvalidInput(scene.source + ": the lattice's position is not finite");
  // The spacing is checked too, because the squares of large steps overflow before the steps do.
  const glm::dvec3 spacing_mm = lattice.spacing_mm();
  if (!std::isfinite(spacing_mm.x + spacing_mm.y + spacing_mm.z) ||
      !glm::all(glm::greaterThan(spacing_mm, glm::dvec3(0.0))))
    throw InvalidInput(scene.source + ": the lattice's spacing is not a finite length in millimetres");
}

double interpolate(const Scene& scene, const glm::dvec3& p_voxel) {
  assert(scene.lattice.sample_count() > 0);
  const glm::ivec3 dims = scene.lattice.dims;
  const glm::dvec3 p = glm::clamp(p_voxel, glm::dvec3(0.0), glm::dvec3(dims - 1));
  const glm::ivec3 low = glm::min(glm::ivec3(p), glm::max(dims - 2, glm::ivec3(0)));
  const glm::dvec3 t = p - glm::dvec3(low);
  return std::visit(
      [&](const auto& samples) {
        const auto at = [&](int x, int y, int z) {
          const glm::ivec3 i = glm::min(low + glm::ivec3(x, y, z), dims - 1);
          const auto row = static_cast<std::size_t>(i.z) * static_cast<std::size_t>(dims.y) +
                           static_cast<std::size_t>(i.y);
          return static_cast<double>(
              samples[row * static_cast<std::size_t>(dims.x) + static_cast<std::size_t>(i.x)]);
        };
        if (scene.padding)
          for (int corner = 0; corner < 8; ++corner) {
            const glm::ivec3 side(corner & 1, corner >> 1 & 1, corner >> 2);
            const glm::dvec3 share = glm::mix(1.0 - t, t, glm::dvec3(side));
            if (share.x * share.y * share.z > 0.0 && at(side.x, side.y, side.z) == *scene.padding)
              return *scene.padding;
          }
        const auto along_x = [&](int y, int z) { return at(0, y, z) * (1.0 - t.x) + at(1, y, z) * t.x; };
        const auto along_y = [&](int z) { return along_x(0, z) * (1.0 - t.y) + along_x(1, z) * t.y; };
        return along_y(0) * (1.0 - t.z) + along_y(1) * t.z;
      },
      scene.samples);
}

}  // namespace octotomy::voxel
