// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/space/scene.h"

namespace octotomy::voxel {

/// Takes as padding what only padding can be in a CT whose file names none. Many converters drop that
/// statement and keep the samples: corners of -2000 or -3024 around a round field of view.
///
/// Taken is the least sample if it lies below -1100 HU, thus below air and its noise, if at least 64 samples
/// and one in ten thousand hold it, and if the hundred units above it are empty but for one sample for each
/// hundred of its own. The audit gains a WARN, since it is a guess; nothing happens otherwise. Precondition:
/// samples in Hounsfield units, no padding taken yet. Two passes over the samples.
void take_unstated_padding(Scene& scene);

}  // namespace octotomy::voxel
