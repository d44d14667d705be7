// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/tree/grey_octree.h"
#include "voxel/view/render.h"

namespace octotomy::voxel {

/// The criterion by which a ray meets a surface in the samples f (Hoehne, Bernstein 1986; thesis 4.4.2.3).
/// Range: f is in low..high (equation 4.8). Derivative: f rises along the ray by more than `steeper_per_mm`
/// (4.9). Gradient: f changes by more than `steeper_per_mm` in some direction (4.10).
enum class Criterion { Range, Derivative, Gradient };

/// The definition of the surface that ends a ray.
struct Decision {
  Criterion by = Criterion::Range;
  double low = 0.0;             ///< Range: lower bound in the samples' unit, included
  double high = 0.0;            ///< Range: upper bound, included
  double steeper_per_mm = 0.0;  ///< Derivative, Gradient: in the samples' unit per mm
  /// The number of stretches on which the criterion is true that a ray passes before it ends at the next one;
  /// 0 shows the outermost layer.
  int peeled = 0;
};

/// Throws std::invalid_argument if a number is not finite, the range is empty, `steeper_per_mm` is not
/// positive or `peeled` is negative.
void check(const Decision& decision);

/// Draws the surface in the samples of an object; of its octree only the universe is read. The criterion is
/// tested at steps of half a voxel's shortest edge between the outermost voxels' centres, with trilinear
/// samples; the beginning of a stretch is then halved down to 1/512 of a step. The derivative is a central
/// difference over two steps, the gradient has trilinear central differences (equation 5.3). Parts that the
/// options' cuts remove, and places beyond the scan, have no surface. Derivative and Gradient find no surface
/// where they would depend on samples beyond the scan. The options' algorithm and count are ignored.
/// Precondition: the object has samples in its universe and was not moved. Throws as render() and check() do.
/// Parallel over rows; same bits on any thread count. Cost: all steps of each ray up to its surface, except
/// in leaves that certainly contain no surface, and a byte for each leaf of 4 x 4 x 4 voxels.
Picture decide(const DrawnObject& object, const RenderOptions& options, const Decision& decision);

}  // namespace octotomy::voxel
