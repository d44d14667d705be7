// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

// Decides from the air in a scan, which is -1000 HU by definition, whether samples are Hounsfield units and
// which samples are too low to be measurements. A sample within 100 of -1000 is air. A scan has air if at
// least one sample in a thousand is air.

struct AirLevel {
  Meaning meaning = Meaning::Raw;
  Finding finding;
};

/// For scans that declare themselves CT. With air: Hounsfield, Pass. Without air, but with at least one
/// sample in a thousand between -900 and -20 (fat, foam, partial volume): Hounsfield, Warn. With neither, as
/// when an intercept of -1024 was lost: Raw, Fail.
AirLevel air_level_of_ct(const Scene& scene);

/// For files that do not state their modality. Hounsfield if the scan has air and the air is a peak: at least
/// twice as many samples as the band of equal width above it. That is a guess and therefore a Warn. Otherwise
/// Raw, Pass: nothing is assumed.
AirLevel air_level_of_unnamed(const Scene& scene);

/// Detects negative numbers that were stored or read as unsigned 16-bit numbers, which makes air or padding
/// brighter than bone. Evidence: samples above 40000, which no CT measures, and a gap of at least 32768
/// between these and all other samples. Requires at least 64 samples above 40000, and one in ten thousand. A
/// FAIL in a CT, a WARN otherwise; none if there are no such samples. Does not change the samples. Cost: two
/// passes over samples in single precision; signed 16-bit samples cannot hold such numbers and are not read.
std::optional<Finding> lost_sign_finding(const Scene& scene, bool is_ct);

/// Marks samples as padding that a CT cannot have measured, although the file states no padding. Many
/// converters drop the statement and keep the samples: corners of -2000 or -3024 around a round field of
/// view.
///
/// The lowest sample that is not padding yet becomes padding if three conditions hold. It lies below -1100
/// HU, thus below air and its noise. At least 64 samples and one in ten thousand have this value. The hundred
/// units above it hold at most one sample for each hundred samples of this value. The audit then has a WARN,
/// because this is a guess. If a condition fails, the scene is unchanged. In a scene that already has
/// padding, these samples are set to the padding's value. Precondition: samples in Hounsfield units. Cost:
/// two passes over the samples.
void take_unstated_padding(Scene& scene);

}  // namespace octotomy::voxel
