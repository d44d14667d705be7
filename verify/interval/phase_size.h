// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "verify/interval/two_phase.h"

// The volume and area of a solid of one density, computed from sums over its samples (PhaseEvidence).
// phase_size.cpp has the derivations.
namespace octotomy::verify {

/// Returns the volume: the sum of the samples' shares of the contrast, times the volume of a sample.
Interval phase_volume(const PhaseEvidence& found, double sample_mm3);

/// Returns the area, fitted to the sums of squares and to the areas of the half level after each added blur.
/// None: no blurred solid of one density fits them. Cost: some ten thousand evaluations of the model.
std::optional<Interval> phase_area(const PhaseEvidence& found, const glm::dvec3& spacing_mm);

}  // namespace octotomy::verify
