// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/scan/slice_plan.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

using SceneSamples = decltype(Scene::samples);

/// The samples of a plan's lattice, interpolated linearly between the pixels of a slice and between slices,
/// each shifted by the plan's aside_px. Beyond either of two slices they are the padding, or without one the
/// least of all samples. A sample that would mix padding with a measurement is padding. Integers are rounded,
/// halves upwards. Parallel over slices.
SceneSamples upright_samples(const SlicePlan& plan, const glm::ivec2& slice_px, const SceneSamples& stored,
                             std::optional<double> padding = std::nullopt);

/// A scan whose slices lean, the lattice's third axis not being across the first two, straightened as a DICOM
/// series with a tilted gantry is on reading. Its lattice is wider by as much as the slices are shifted.
/// Precondition: the first two axes are perpendicular.
Scene upright(const Scene& scene);

}  // namespace octotomy::voxel
