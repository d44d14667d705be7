// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "verify/witness/reading.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

/// Classes of samples by two features: x is the density in the scan's unit, y the length of the gradient in that unit
/// per millimetre. `meant` is the number of the class that the witness describes.
struct ClassedBy {
  std::vector<glm::dvec2> centres;
  glm::dvec2 scale{1.0};  ///< both features are divided by it before distances are compared
  std::size_t meant = 0;
};

/// A witness of the samples whose features lie nearest to the centre `meant`. Computes the gradients by its
/// own code. At a sample both sides are certain, unless two centres are equally near within rounding, or
/// padding lies beside it; beyond the scan all is outside. Elsewhere a point is certain where the eight
/// samples about it agree. Shares the scan. Throws std::invalid_argument if `meant` is not the number of a
/// centre.
Witness witness_of_class(std::shared_ptr<const voxel::Scene> scan, const ClassedBy& by);

}  // namespace octotomy::verify
