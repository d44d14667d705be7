// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/scene.h"

namespace octotomy::voxel {

// Judges by their air, which is -1000 by definition, if samples are Hounsfield units, and what lies too far
// below it to be measured. Air is a sample within 100 of -1000. Air is seen if at least one sample in a
// thousand is air.

struct AirLevel {
  Meaning meaning = Meaning::Raw;
  Finding finding;
};

/// For scans that declare themselves CT. Air seen: Hounsfield, Pass. No air, but at least one sample in a
/// thousand between -900 and -20 (fat, foam, partial volume): Hounsfield, Warn. Neither, as after a lost
/// intercept of -1024: Raw, Fail.
AirLevel air_level_of_ct(const Scene& scene);

/// For files that do not state their modality. Hounsfield if air is seen and is a peak: at least twice as
/// many samples as in the equally wide band above it. Warn, since it is a guess. Otherwise Raw, Pass: nothing
/// is assumed.
AirLevel air_level_of_unnamed(const Scene& scene);

/// Numbers below 0 that were stored or read as 16 bits without a sign, so that air or padding is brighter
/// than bone: samples above 40000, beyond what a CT measures, with nothing between them and the others for
/// half of the numbers of 16 bits, at least 64 of them and one in ten thousand. A FAIL in a CT, else a WARN;
/// none where there are none. The samples stay as they are. Cost: two passes over samples in single
/// precision; those of 16 bits with a sign cannot hold such numbers.
std::optional<Finding> lost_sign_finding(const Scene& scene, bool is_ct);

/// Takes as padding what only padding can be in a CT and what its file does not name. Many converters drop
/// that statement and keep the samples: corners of -2000 or -3024 around a round field of view.
///
/// Taken is the least sample that is no padding yet if it lies below -1100 HU, thus below air and its noise,
/// if at least 64 samples and one in ten thousand hold it, and if the hundred units above it are empty but
/// for one sample for each hundred of its own. The audit gains a WARN, since it is a guess; nothing happens
/// otherwise. In a scene that has padding already the samples become that. Precondition: samples in
/// Hounsfield units. Two passes over the samples.
void take_unstated_padding(Scene& scene);

}  // namespace octotomy::voxel
