// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "verify/certificate/certificate.h"
#include "verify/witness/reading.h"
#include "voxel/space/progress.h"
#include "voxel/tree/octree.h"

namespace octotomy::verify {

struct AloneInputs {
  std::string operation;
  std::string lineage;              ///< of the voxels
  std::vector<std::string> makers;  ///< of the voxels; see Answer::makers
  Witness witness;                  ///< not empty; ends with the universe, as the voxels do
};

/// Judges an object that the voxel kernel alone made (tier Bounded). The witness must allow the octree's
/// side, inside or outside, at the centre of every voxel of the universe. The witness's reading replaces the
/// mesh kernel's answer and has the same makers as the voxels. So the certificate is not independent, states
/// so, and is a WARN at best. The detection limit is a voxel plus the volume in which the witness allows both
/// sides. Throws voxel::Stopped. Cost: a reading of the witness for each voxel of the universe.
Certificate certify_alone(const voxel::Octree& octree, const AloneInputs& inputs,
                          const voxel::Progress& progress = {});

}  // namespace octotomy::verify
