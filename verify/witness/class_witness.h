// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "verify/witness/reading.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

/// The classes of a scan's samples. A sample has two features: x is its density in the scan's unit, y the
/// length of its gradient in that unit per millimetre. A sample belongs to the class with the nearest centre.
/// `meant` is the number of the class that the witness describes.
struct ClassedBy {
  std::vector<glm::dvec2> centres;
  glm::dvec2 scale{1.0};  ///< features are divided by `scale` before distances are compared
  std::size_t meant = 0;
};

/// A witness of the samples of class `meant`. It computes the gradients by code that no kernel shares. At a
/// sample both sides are certain, unless two centres are equally near within rounding, or padding lies beside
/// the sample. Beyond the scan all is outside. Elsewhere a point is certain where the eight samples about it
/// agree. Shares the scan. Throws std::invalid_argument if `meant` is not the number of a centre.
Witness witness_of_class(std::shared_ptr<const voxel::Scene> scan, const ClassedBy& by);

}  // namespace octotomy::verify
