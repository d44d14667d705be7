// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <vector>

#include "voxel/scan/slice_plan.h"
#include "voxel/space/scene.h"

namespace octotomy::voxel {

using SceneSamples = decltype(Scene::samples);

/// The samples of a plan's lattice, interpolated linearly between the pixels of a slice and between slices;
/// beyond either of two slices they are the least of all samples. `aside_px` tells how far each slice of the
/// stack lies aside of the first. Integers are rounded, halves upwards. Parallel over slices.
SceneSamples upright_samples(const SlicePlan& plan, const glm::ivec2& slice_px,
                             const std::vector<glm::dvec2>& aside_px, const SceneSamples& stored);

/// A scan whose slices lean, the lattice's third axis not being across the first two, straightened as a DICOM
/// series with a tilted gantry is on reading. Its lattice is wider by as much as the slices are shifted.
/// Precondition: the first two axes are perpendicular.
Scene upright(const Scene& scene);

}  // namespace octotomy::voxel
