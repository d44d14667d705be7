// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "voxel/solid/digitise.h"
#include "voxel/solid/expression.h"

namespace octotomy::verify {

/// Place and size of a solid. The middle of the universe is the LPS origin.
struct SolidPhantomOptions {
  int voxels = 256;                     ///< along a side of the universe: a power of two, 4 to 4096
  std::optional<double> radius_voxels;  ///< R in units of the least spacing; default: voxels / 4
  glm::dvec3 spacing_mm{1.0};
  glm::dvec3 centre_mm{0.0};
  glm::dmat3 lps_from_axes{1.0};  ///< columns: the axes of the turned solid in LPS
};

/// A solid of known volume and area. An octree in `shape` is a set of voxels of this universe.
struct SolidPhantom {
  voxel::Universe universe;
  voxel::Expression shape;
  double volume_mm3 = 0.0;
  double area_mm2 = 0.0;
  glm::dvec3 centroid_mm{0.0};
};

/// A kind of solid, with a description in which R is the radius. solid_phantom_kinds() lists all.
struct SolidPhantomKind {
  std::string_view name;
  std::string_view what;
};
const std::vector<SolidPhantomKind>& solid_phantom_kinds();

/// Returns a solid of a kind. Volume, area and centroid are closed forms; an ellipsoid's area is an integral
/// with a relative error below 1e-9. Throws std::invalid_argument if the kind is unknown, an option is out of
/// its range, or the solid does not fit its universe. `chequered_sphere` and `figure_3_1` are fixed to the
/// lattice: a turn or another centre is out of range for both, and a radius for figure_3_1.
SolidPhantom solid_phantom(std::string_view kind, const SolidPhantomOptions& options = {});

/// Returns the voxels of the solid's universe that belong to it: by one of the rules D1 to D4, or with the
/// filled share of every boundary voxel.
inline voxel::Octree digitise(const SolidPhantom& solid, voxel::Digitisation digitisation) {
  return voxel::digitise(solid.universe, solid.shape, digitisation);
}
inline voxel::PartialOctree digitise_partial(const SolidPhantom& solid) {
  return voxel::digitise_partial(solid.universe, solid.shape);
}

}  // namespace octotomy::verify
