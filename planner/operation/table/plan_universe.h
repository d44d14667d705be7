// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "voxel/space/lattice.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// The universe in which a plan is evaluated: around the scan's bounds, with voxels of edge `voxel_mm`.
/// Default: the scan's smallest spacing, or a larger one at which the bounds have 512 voxels a side. A
/// voxel's centre lies on the scan's first sample, so that samples with the spacing of voxels are copied
/// unchanged. Throws voxel::Error (Resource), with the figures, if voxels finer than the samples may take
/// more memory than is free.
voxel::Universe universe_of(const voxel::Lattice& scan, std::optional<double> voxel_mm);

/// The universe of a scan. The samples of a label map are cells; `are_labels` declares a label map whose file
/// does not state it. Then borders of voxels lie on those of the first cell: otherwise all voxels with their
/// centre on a border between two cells would be assigned to the same side.
voxel::Universe universe_of(const voxel::Scene& scan, std::optional<double> voxel_mm,
                            bool are_labels = false);

/// The universe of a plan without scans: around all boxes of its meshes and tiled contours, with room for
/// motions of half the longest box on all sides. Default: voxels of a 128th of the longest box, or larger ones
/// at which the universe has 512 a side. Throws std::invalid_argument if there is no box, or none has an extent.
voxel::Universe universe_of(const std::vector<voxel::Box>& meshes, std::optional<double> voxel_mm);

}  // namespace octotomy::planner
