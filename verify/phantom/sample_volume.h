// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>

#include "voxel/space/lattice.h"

namespace octotomy::verify {

/// A volume by regular sampling of a predicate, with the method's standard error on curved boundary.
struct SampledVolume {
  double volume_mm3 = 0.0;
  double standard_error_mm3 = 0.0;
};
/// Samples a box at the centres of cubic cells of edge `step_mm`; cells shrink so that a whole number of them
/// fits the box. Throws std::invalid_argument if the step or the box has no size. Standard error: 0.3 step^2
/// sqrt(S), S the boundary's area estimated from the same samples. Parallel; same bits on any thread count.
SampledVolume sample_volume(const voxel::Box& box, double step_mm,
                            const std::function<bool(const glm::dvec3&)>& inside);

}  // namespace octotomy::verify
