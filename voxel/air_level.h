// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/scene.h"

namespace octotomy::voxel {

// Whether samples are Hounsfield units, judged by their air, which is -1000 by definition. "Air" is what lies
// within 100 of -1000; it counts as seen where it is at least one sample in a thousand.

struct AirLevel {
  Meaning meaning = Meaning::Raw;
  Finding finding;
};

/// For scans that declare themselves CT. Air seen: Hounsfield, Pass. No air, but at least one sample in a
/// thousand between -900 and -20 (fat, foam, partial volume): Hounsfield, Warn. Neither, as where an
/// intercept of -1024 is missing: Raw, Fail.
AirLevel air_level_of_ct(const Scene& scene);

/// For files that do not say their modality. Hounsfield where air is seen and is a peak: at least twice as
/// many samples as in the equally wide band above it. Otherwise Raw. Both are Pass, and the finding says so.
AirLevel air_level_of_unnamed(const Scene& scene);

}  // namespace octotomy::voxel
