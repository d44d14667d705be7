// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Points spread over a surface, each standing for some of its area.
struct SurfaceSamples {
  std::vector<glm::dvec3> points_mm;
  std::vector<glm::dvec3> normals;  ///< unit, of the points' triangles
  std::vector<double> areas_mm2;
  double reach_mm = 0.0;  ///< no point of the surface lies further than this from a sample
};

/// Splits each triangle into n * n equal ones with sides of at most `spacing_mm`, a sliver into cells of
/// at most that diameter, and takes their centres of gravity, by triangle. Triangles without area get none.
/// Throws std::invalid_argument where the spacing is not positive; Error, Resource, where that makes more
/// than `most_samples`, of which 2^26 are the limit. Cost: linear in the samples, 56 bytes each; at least one
/// a triangle, and a few for each square of the spacing and each stretch of it along a sliver.
SurfaceSamples sample_surface(const Mesh& mesh, double spacing_mm);
SurfaceSamples sample_surface(const Triangles& triangles, double spacing_mm,
                              std::size_t most_samples = std::size_t{1} << 26);

/// The spacing itself, or a larger one at which the triangles with sides longer than it, which may be
/// slivers, take at most about so many samples for their length. Of well-shaped triangles the area decides:
/// give several times what that takes.
double widened_spacing_mm(const Triangles& triangles, double spacing_mm, double most_samples);

}  // namespace octotomy::brep
