// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/align/register_surfaces.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/oriented_surface.h"

// The refinement that register_surfaces() ends with, for what has its samples and a start already.
namespace octotomy::brep {

/// Points of a surface, each for the same area.
struct Cloud {
  std::vector<glm::dvec3> points_mm, normals;
  glm::dvec3 centre_mm{0.0};
  double spread_mm = 0.0;  ///< root mean square distance from the centre
  glm::dmat3 axes{1.0};    ///< columns, by falling spread, right-handed
};

/// So many samples. Throws std::invalid_argument where the surface has no area.
Cloud cloud_of(const Mesh& mesh, std::size_t count, const std::string& which);

/// The fit from `start`, short of the widening to all samples within the noise unless `widens`. Throws and
/// tells as register_surfaces().
SurfaceFit fit_cloud(const Cloud& moving, const OrientedSurface& fixed, const glm::dmat4& start,
                     const SurfaceFitOptions& options, bool widens = true);

}  // namespace octotomy::brep
