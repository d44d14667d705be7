// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "verify/interval/two_phase.h"

// The size of a solid of one density from the sums of its samples. The source has the derivations.
namespace octotomy::verify {

/// The volume that the samples' shares of the contrast sum to.
Interval phase_volume(const PhaseEvidence& found, double sample_mm3);

/// The area that lets blurs of the samples leave these sums of squares and this half level; none where no
/// blurred solid does. Cost: some ten thousand fits.
std::optional<Interval> phase_area(const PhaseEvidence& found, const glm::dvec3& spacing_mm);

}  // namespace octotomy::verify
