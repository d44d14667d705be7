// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// For each point the first one that has the same coordinates, itself where it is the first; 0.0 and -0.0 are
/// equal, what is no number equals nothing. Cost: linear; 12 to 20 bytes a point.
std::vector<std::uint32_t> first_equal_points(const std::vector<glm::dvec3>& points_mm);

/// 1 for each point at whose place triangles of more than one label have a corner, 0 for others. `first` is
/// first_equal_points() of the points, `label` one number a triangle. Cost: linear.
std::vector<std::uint8_t> shared_points(const Triangles& triangles, const std::vector<std::uint32_t>& first,
                                        const std::vector<std::uint32_t>& label);

}  // namespace octotomy::brep
