// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"
#include "voxel/tree/grey_octree.h"
#include "voxel/tree/octree.h"

// Removal of the table, the headrest and other things scanned beside the patient.
namespace octotomy::voxel {

struct HeadrestOptions {
  double threshold = -300.0;  ///< samples of at least this value are solid, HU
  /// For a headrest that touches the patient: cuts links thinner than a ball of this radius. None: cuts no
  /// link; parts are the components by voxel faces.
  std::optional<double> detach_mm;
  /// For a board or couch that lies flush with the patient: what board_of() finds up to this thickness is a
  /// part of its own. None: no board is sought.
  std::optional<double> board_mm;
  /// Parts wholly within this distance of the patient belong to the patient, such as an ear that was cut off,
  /// bone fragments or teeth. Parts that reach farther are removed.
  double near_mm = 25.0;
  std::vector<glm::dvec3>
      keep_mm;  ///< LPS points of parts to keep at any distance, such as a dry skull's jaw
  /// Width of the blurred edge that is removed with a part; voxels as near to the patient stay.
  double rim_mm = 2.0;
  std::int16_t fill = -1000;  ///< the value of removed samples: air
  Progress progress{};
};

struct HeadrestRemoval {
  Scene scene;
  /// The removed samples, on a universe of the scene's own voxels (universe_on()). The background is a value
  /// that no removed sample has. restore() undoes the removal with it.
  GreyOctree removed;
  Octree solid;  ///< the removed voxels of at least the threshold
  std::uint64_t parts = 0;
  std::uint64_t voxels = 0;  ///< all removed voxels, rim included
  double solid_mm3 = 0.0;
};
/// Removes the solid parts that are not the patient, who is the largest part. A single part stays. Throws
/// std::invalid_argument if samples are not int16, the axes are not perpendicular, or an option is negative
/// or not finite; Error, Geometry, if nothing is solid; Stopped. Same bits on any thread count. Memory: the
/// result, and 8 bytes per sample for distances.
HeadrestRemoval remove_headrest(Scene scene, const HeadrestOptions& options);

/// Restores the samples that remove_headrest() removed and returns their number. Throws std::invalid_argument
/// if the removed voxels are not on the scene's lattice, to a thousandth of a voxel, or its samples are not
/// int16.
std::uint64_t restore(Scene& scene, const GreyOctree& removed);

}  // namespace octotomy::voxel
