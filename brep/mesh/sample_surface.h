// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Points spread over a surface; each represents a part of its area.
struct SurfaceSamples {
  std::vector<glm::dvec3> points_mm;
  std::vector<glm::dvec3> normals;  ///< unit normals of the points' triangles
  std::vector<double> areas_mm2;
  double reach_mm = 0.0;  ///< largest distance of a point of the surface from a sample
};

/// Splits each triangle into n * n equal ones with sides of at most `spacing_mm`, a sliver into cells of at
/// most that diameter. The samples are the centres of gravity of these parts, in order of triangles.
/// Triangles without area have no samples. Throws std::invalid_argument if the spacing is not positive;
/// Error, Resource, if there would be more than `most_samples`, at most 2^26. Cost: linear in the samples, 56
/// bytes each. There is at least one sample per triangle, and a few for each square of the spacing and each
/// spacing along a sliver.
SurfaceSamples sample_surface(const Mesh& mesh, double spacing_mm);
SurfaceSamples sample_surface(const Triangles& triangles, double spacing_mm,
                              std::size_t most_samples = std::size_t{1} << 26);

/// The spacing, enlarged if long triangles, such as slivers, would otherwise get more than about
/// `most_samples` samples. Pass several times the number of samples that well-shaped triangles get by their
/// area.
double widened_spacing_mm(const Triangles& triangles, double spacing_mm, double most_samples);

}  // namespace octotomy::brep
