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

/// Judges an object that the voxel kernel alone made (tier Bounded). At the centre of every voxel of the
/// universe, inside and outside the object, its witness must allow the object's side. The witness's reading
/// replaces the mesh kernel's answer and has the same makers as the voxels. So the certificate is not
/// independent, states this, and is a WARN at best. It states the volume in which the witness allows both
/// sides. Throws voxel::Stopped. Cost: a reading of the witness for each voxel of the universe.
Certificate certify_alone(const voxel::Octree& octree, const AloneInputs& inputs,
                          const voxel::Progress& progress = {});

}  // namespace octotomy::verify
