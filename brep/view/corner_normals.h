// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The triangle's unit normal, right-handed; zero if it has no area.
glm::dvec3 facet_normal(const Triangles& triangles, std::size_t facet);

/// Unit normals at the points: the mean of the triangles around each, weighted by their angles there
/// (Thürmer and Wüthrich, Computing vertex normals from polygonal facets, 1998). Zero where the normals
/// cancel out, or at points of no triangle.
std::vector<glm::dvec3> corner_normals(const Triangles& triangles);

}  // namespace octotomy::brep
