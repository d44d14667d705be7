// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <optional>

#include "voxel/space/lattice.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// The universe a plan is evaluated in: around the scan's bounds, voxels of the asked edge; by default the
/// scan's smallest spacing, or what makes the bounds 512 voxels a side where that is larger. A voxel's centre
/// lies on the scan's first sample, so that samples as far apart as voxels are taken over as they are. Throws
/// voxel::Error (Resource) with the figures where voxels finer than the samples may take more memory than is
/// free.
voxel::Universe universe_of(const voxel::Lattice& scan, std::optional<double> voxel_mm);

/// The same for a scan. Samples of a label map are cells, also where the file does not say that it is one and
/// a label of it is wanted, `are_labels`. There voxels' borders lie on those of the first cell: of voxels
/// with their centres on cells' centres, those on a border between two cells would all fall to the same side.
voxel::Universe universe_of(const voxel::Scene& scan, std::optional<double> voxel_mm,
                            bool are_labels = false);

}  // namespace octotomy::planner
