// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>

#include "voxel/filter/patient.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

// Removal of the table, the headrest and other things scanned with the patient.
namespace octotomy::voxel {

struct HeadrestOptions {
  PatientOptions patient{};
  std::int16_t fill = -1000;  ///< the value of removed samples: air
};

struct HeadrestRemoval {
  Scene scene;
  /// The removed samples, from which restore() undoes the removal. The octree's voxels are those of the scene
  /// (universe_on()). No removed sample equals the octree's background.
  GreyOctree removed;
  Octree solid;              ///< the removed voxels with samples of at least the threshold
  std::uint64_t parts = 0;   ///< number of parts of `solid`, joined by faces
  std::uint64_t voxels = 0;  ///< number of all removed voxels, rim and foam included
  double solid_mm3 = 0.0;
  double foam_mm3 = 0.0;  ///< removed volume with samples below the threshold: foam, cloth, blurred edges
  /// Removed volume with samples of at least dense_hu: metal, carbon, dense plastic.
  double bone_mm3 = 0.0;
  double middle_y_mm = 0.0;  ///< the patient's coronal middle, LPS; nothing in front of it is removed
  double front_mm3 = 0.0, behind_mm3 = 0.0, extruded_front_mm3 = 0.0;  ///< as in PatientParts
};
/// Overwrites with air the samples that patient_parts() classes as supports. Samples in front of the
/// patient's coronal middle, or enclosed by skin or bone, are never overwritten. Throws as patient_parts()
/// does; std::runtime_error if no sample is solid. Same bits on any thread count. Memory: the result and the
/// memory of patient_parts().
HeadrestRemoval remove_headrest(Scene scene, const HeadrestOptions& options = {});

/// Restores the samples that remove_headrest() removed and returns their number. Throws std::invalid_argument
/// if the removed voxels are not on the scene's lattice, to a thousandth of a voxel, or the scene's samples
/// are not int16.
std::uint64_t restore(Scene& scene, const GreyOctree& removed);

}  // namespace octotomy::voxel
