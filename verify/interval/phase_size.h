// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "verify/interval/two_phase.h"

// Volume and area of a solid of one density, from sums over its samples. The source has the derivations.
namespace octotomy::verify {

/// The volume: the sum of the samples' shares of the contrast times the volume of a sample.
Interval phase_volume(const PhaseEvidence& found, double sample_mm3);

/// The area, fitted to the sums of squares and the areas of the half level after each added blur. None: no
/// blurred solid fits them. Cost: some ten thousand evaluations of the model.
std::optional<Interval> phase_area(const PhaseEvidence& found, const glm::dvec3& spacing_mm);

}  // namespace octotomy::verify
