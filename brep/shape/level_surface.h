// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/measure.h"
#include "brep/mesh/solid.h"
#include "brep/shape/offset.h"

// The surface on which a field of signed distances is 0. The last step of offsets and of level bodies.
namespace octotomy::brep {

/// Values at points, LPS, negative inside. A value changes by at most the distance between points. `nearest`
/// has one number for each point: SurfaceTree::unknown_triangle, or the number that an earlier call stored
/// for a nearby point.
using LevelField = std::function<std::vector<double>(const std::vector<glm::dvec3>& points_mm,
                                                     std::vector<std::uint32_t>& nearest)>;

/// The surface where the field is 0, by cells of the options' size. The field is that of a solid offset by
/// `options.by_mm`; `size` is the solid's size before the offset. Guarantees, throws and costs as offset().
Solid level_surface(const LevelField& field, const Size& size, const OffsetOptions& options);

}  // namespace octotomy::brep
