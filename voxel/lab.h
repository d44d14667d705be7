// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::voxel {

// CIE 1976 L*a*b* about sRGB's white (D65): equal distances look about equally large, one being what is just
// noticed. Source: CIE 15:2004; IEC 61966-2-1.

/// Of an sRGB colour, 0..1.
glm::dvec3 lab_from_srgb(const glm::vec3& colour);

/// The inverse; colours beyond sRGB are cut off at its sides.
glm::vec3 srgb_from_lab(const glm::dvec3& lab);

}  // namespace octotomy::voxel
