// SPDX-License-Identifier: AGPL-3.0-or-later
#include "convert/surface/expression_surface.h"

#include <algorithm>
#include <span>

#include "convert/surface/surface_extraction.h"
#include "voxel/solid/combine.h"
#include "voxel/solid/membership.h"

namespace octotomy::convert {
namespace {

/// The least distance of a surface point from a sample, as a part of the edge. Points of different edges stay
/// distinct, and with voxels of up to 16 mm a point lies less than a nanometre off a cut.
constexpr double closest_to_sample() {
  return 0x1p-24;
}

/// Halvings of an edge: they leave an error of 2^-40 of the edge.
constexpr int halvings = 40;

}  // namespace

brep::Triangles isosurface(const voxel::Universe& universe, const voxel::Expression& expression,
                           const voxel::Progress& progress) {
  progress.at(0.0);
  const voxel::Lattice lattice = universe.lattice();
  const voxel::Membership inside(universe, expression);
  const auto crossing = [&](const CrossedEdge& edge) {
    const glm::dvec3 first_mm = lattice.lps_mm(edge.voxel);
    glm::ivec3 next = edge.voxel;
    ++next[edge.axis];
    const glm::dvec3 step_mm = lattice.lps_mm(next) - first_mm;
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      (inside(first_mm + middle * step_mm) == edge.first_inside ? low : high) = middle;
    }
    return std::clamp(0.5 * (low + high), closest_to_sample(), 1.0 - closest_to_sample());
  };
  const Crossings crossings = [&](std::span<const CrossedEdge> edges, double* parts) {
    std::transform(edges.begin(), edges.end(), parts, crossing);
  };
  return extract_surface(lattice, inside_bits(combine(universe, expression)), crossings, progress);
}

}  // namespace octotomy::convert
