// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "brep/align/register_surfaces.h"
#include "brep/mesh/mesh.h"
#include "brep/mesh/oriented_surface.h"

// The final refinement of register_surfaces(), for callers that already have samples and a start.
namespace octotomy::brep {

/// Points of a surface; each represents the same area.
struct Cloud {
  std::vector<glm::dvec3> points_mm, normals;
  glm::dvec3 centre_mm{0.0};
  double spread_mm = 0.0;  ///< root mean square distance from the centre
  glm::dmat3 axes{1.0};    ///< columns, by falling spread, right-handed
};

/// Spreads `count` samples over the surface. Throws std::invalid_argument, naming the surface by `which`, if
/// it has no area.
Cloud cloud_of(const Mesh& mesh, std::size_t count, const std::string& which);

/// The fit from `start`. Only if `widens` is set, the last step uses all samples within the noise. Throws and
/// reports progress as register_surfaces() does.
SurfaceFit fit_cloud(const Cloud& moving, const OrientedSurface& fixed, const glm::dmat4& start,
                     const SurfaceFitOptions& options, bool widens = true);

}  // namespace octotomy::brep
