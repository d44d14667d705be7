// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

// Decides by the air in a scan whether samples are Hounsfield units, and which samples are too low to be
// measurements. Air is -1000 HU by definition. A sample within 100 of -1000 counts as air, and a scan has air
// if at least one sample in a thousand is air.

struct AirLevel {
  Meaning meaning = Meaning::Raw;
  Finding finding;
};

/// For scans that declare themselves CT. With air: Hounsfield, Pass. Without air, but with at least one
/// sample in a thousand between -900 and -20 (fat, foam, partial volume): Hounsfield, Warn. If there is
/// neither, for example because an intercept of -1024 was lost: Raw, Fail.
AirLevel air_level_of_ct(const Scene& scene);

/// For files that do not state their modality. Hounsfield if the scan has air and the air forms a peak: at
/// least twice as many samples as the band of equal width above. The finding is then a Warn, because this is
/// a guess. Otherwise Raw, Pass: nothing is assumed.
AirLevel air_level_of_unnamed(const Scene& scene);

/// Detects negative numbers that were stored or read as unsigned 16-bit numbers, which makes air or padding
/// brighter than bone. Evidence: samples above 40000, which no CT measures, and a gap of at least 32768
/// between these and all other samples. Requires at least 64 samples above 40000, and one in ten thousand.
/// The finding is a FAIL in a CT and a WARN otherwise; none if there are no such samples. Does not change the
/// samples. Cost: two passes over samples in single precision; signed 16-bit samples cannot hold such numbers
/// and are not read.
std::optional<Finding> lost_sign_finding(const Scene& scene, bool is_ct);

/// Marks samples that a CT cannot have measured as padding, although the file states no padding. Many
/// converters drop this statement but keep the samples: corners of -2000 or -3024 around a round field of
/// view.
///
/// The lowest sample that is not padding yet becomes padding if three conditions hold. It lies below -1100
/// HU, thus below air and its noise. At least 64 samples and one in ten thousand have this value. In the
/// hundred units above it there is at most one sample for each hundred samples of this value. The audit then
/// has a WARN, because this is a guess. If a condition fails, the scene is unchanged. If the scene already
/// has padding, the new samples are set to that padding's value. Precondition: samples in Hounsfield units.
/// Cost: two passes over the samples.
void take_unstated_padding(Scene& scene);

}  // namespace octotomy::voxel
