// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "voxel/space/lattice.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// The universe in which a plan is evaluated. It contains the scan's bounds and has voxels with the edge
/// `voxel_mm`, by default the scan's smallest spacing, or a larger one at which the bounds have 512 voxels a
/// side. A voxel's centre lies on the scan's first sample, so that samples with the spacing of voxels are
/// copied unchanged. Throws voxel::Error (Resource) that states the sizes if voxels finer than the samples
/// may need more memory than is free.
voxel::Universe universe_of(const voxel::Lattice& scan, std::optional<double> voxel_mm);

/// The universe of a scan, with `voxel_mm` as above. If the scan is a label map, by its file or by
/// `are_labels`, each sample stands for a cell, and borders of voxels are aligned with the border of the
/// first cell where there is room. Otherwise the voxel centres on a border between two cells would all be
/// assigned to the same side.
voxel::Universe universe_of(const voxel::Scene& scan, std::optional<double> voxel_mm,
                            bool are_labels = false);

/// The universe of a plan without scans: around all boxes of its meshes and tiled contours, with half the
/// longest box as room for motions on each side. By default, voxels have a 128th of the longest box as edge,
/// or a larger one at which the universe has 512 a side. Throws std::invalid_argument if there is no box, or
/// if no box has an extent.
voxel::Universe universe_of(const std::vector<voxel::Box>& meshes, std::optional<double> voxel_mm);

}  // namespace octotomy::planner
