// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "voxel/grey_octree.h"
#include "voxel/octree.h"
#include "voxel/progress.h"
#include "voxel/scene.h"

// The table, the headrest and whatever else was scanned beside the patient.
namespace octotomy::voxel {

struct HeadrestOptions {
  double threshold = -300.0;  ///< solid things are the samples from here on, HU
  /// Where the rest touches the patient: links that a ball of this radius does not pass are cut. None: parts
  /// are what touches by voxels' faces.
  std::optional<double> detach_mm;
  /// Parts that lie wholly within this distance of the patient are the patient's: an ear that was cut off,
  /// bone fragments, teeth. What reaches farther is not.
  double near_mm = 25.0;
  std::vector<glm::dvec3> keep_mm;  ///< LPS points of parts to keep whatever they reach: a dry skull's jaw
  double rim_mm =
      2.0;  ///< the blurred edge of what is removed goes with it, but for what is as near to the patient
  std::int16_t fill = -1000;  ///< what is left in its place: air
  Progress progress{};
};

struct HeadrestRemoval {
  Scene scene;
  /// The samples taken out, on a universe of the scene's own voxels (universe_on()); all others are its
  /// background, a value that none of them has. restore() undoes the removal with it.
  GreyOctree removed;
  Octree solid;  ///< of these the voxels from the threshold on
  std::uint64_t parts = 0;
  std::uint64_t voxels = 0;  ///< all that were taken out, rim included
  double solid_mm3 = 0.0;
};
/// Takes out the solid parts that are not the patient: the patient is the largest part. Nothing is taken out
/// where there is one part only. Throws std::invalid_argument where samples are not int16, the axes are not
/// at right angles, an option is negative or not finite; std::runtime_error where nothing is solid; Stopped.
/// Same bits on any thread count. Memory: the result, and 8 bytes a sample for distances.
HeadrestRemoval remove_headrest(Scene scene, const HeadrestOptions& options);

/// Puts the samples back that remove_headrest() took out; how many. Throws std::invalid_argument where the
/// removed voxels are not those of the scene's lattice, to a thousandth of a voxel, or its samples not int16.
std::uint64_t restore(Scene& scene, const GreyOctree& removed);

}  // namespace octotomy::voxel
