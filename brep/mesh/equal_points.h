// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace octotomy::brep {

/// For each point the first one that has the same coordinates, itself where it is the first; 0.0 and -0.0 are
/// equal. Precondition: all are finite. Cost: n log n, parallel.
std::vector<std::uint32_t> first_equal_points(const std::vector<glm::dvec3>& points_mm);

}  // namespace octotomy::brep
