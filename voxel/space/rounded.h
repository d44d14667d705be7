// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <string>

namespace octotomy::voxel {

/// A number to three significant digits for messages: "0.0123", "6.04", "5", "1880"; "not a number" and
/// "infinitely many" for values that are not finite.
std::string rounded(double value);
/// A position rounded to whole millimetres: "(12, -80, 44)".
std::string rounded(const glm::dvec3& p_mm);

}  // namespace octotomy::voxel
