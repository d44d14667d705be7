// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/scan/slice_plan.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

using SceneSamples = decltype(Scene::samples);

/// The samples of a plan's lattice, interpolated linearly between the pixels of a slice and between slices,
/// each shifted by the plan's aside_px. Where one of the two slices has no sample, the value is the padding
/// or, if there is none, the lowest of all samples. A sample that would mix padding with a measurement
/// becomes padding. Integers are rounded, halves upwards. Parallel over slices.
SceneSamples tilt_corrected_samples(const SlicePlan& plan, const glm::ivec2& slice_px,
                                    const SceneSamples& stored, std::optional<double> padding = std::nullopt);

/// Resamples a scan whose third axis is not perpendicular to the first two, as read_scene() does for a DICOM
/// series with a tilted gantry. The lattice becomes wider by the shift of the slices. Precondition: the first
/// two axes are perpendicular.
Scene tilt_corrected(const Scene& scene);

}  // namespace octotomy::voxel
