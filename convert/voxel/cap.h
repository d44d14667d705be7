// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::convert {

/// The triangles that close a surface: each loop of its rim is filled. In LPS millimetres. The rim is made of
/// the edges with more triangles one way than the other, each as often as the excess. Points off the rim are
/// moved by `offset_mm`, so that the cap of a flat hole does not lie in the hole's plane.
/// The loops are halved: each is joined by a strip to a loop of half as many points, and so on, so that
/// triangles of later loops are larger, and nodes of trees over all triangles overlap little.
/// Cost: n log n for the rim; about three triangles per edge of it.
std::vector<std::array<glm::dvec3, 3>> cap_of(const brep::Triangles& surface, const glm::dvec3& offset_mm);

}  // namespace octotomy::convert
