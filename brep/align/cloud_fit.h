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

/// Points spread over a surface, with unit normals; each represents the same area.
struct Cloud {
  std::vector<glm::dvec3> points_mm, normals;
  glm::dvec3 centre_mm{0.0};
  double spread_mm = 0.0;  ///< root mean square distance from the centre
  glm::dmat3 axes{1.0};    ///< columns, by falling spread, right-handed
};

/// Spreads `count` samples over the surface. Throws std::invalid_argument, naming the surface by `which`, if
/// it has no area.
Cloud cloud_of(const Mesh& mesh, std::size_t count, const std::string& which);

/// Fits the moving cloud to the surface, from the motion `start` (fixed from moving). If `widens` is set, a
/// last refinement uses all samples within the noise, without a limit on their share. Throws and reports
/// progress as register_surfaces() does.
SurfaceFit fit_cloud(const Cloud& moving, const OrientedSurface& fixed, const glm::dmat4& start,
                     const SurfaceFitOptions& options, bool widens = true);

}  // namespace octotomy::brep
