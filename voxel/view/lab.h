// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

namespace octotomy::voxel {

// CIE 1976 L*a*b* relative to sRGB's white (D65). Colours at equal distances look about equally different; a
// difference of one is just noticeable. Source: CIE 15:2004; IEC 61966-2-1.

/// L*a*b* of an sRGB colour, 0..1.
glm::dvec3 lab_from_srgb(const glm::vec3& colour);

/// The sRGB colour, 0..1, of an L*a*b* colour. Colours outside sRGB are clamped to its range.
glm::vec3 srgb_from_lab(const glm::dvec3& lab);

}  // namespace octotomy::voxel
