// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

namespace octotomy::verify {

/// Hounsfield values of the head phantom. A voxel that is half bone and half soft tissue has exactly 300 HU,
/// so a window from 300 HU digitises bone without bias. All bone is lined by soft tissue.
struct HeadTissues {
  double air = -1000.0;
  double soft = 40.0;
  double bone = 560.0;
  double tooth_core = 1800.0;  ///< more than 2 mm below a tooth's surface; the rest has `bone`
  double headrest = -150.0;
};

/// How the head is scanned. Frame: LPS millimetres; x = 0 is the median plane, the Frankfurt plane is
/// z = -6, the ear canals lie at y = 6; the maxilla lies about (0, -60, -42), the crown at z = 107. The
/// mandible's angle has an exostosis on the patient's left, about (53, -17, -70), and none on the right.
struct HeadOptions {
  double voxel_mm = 1.0;
  std::optional<double> slice_mm;      ///< slice spacing; default voxel_mm
  double gantry_tilt_deg = 0.0;        ///< slices tilted about the patient's x axis
  double point_spread_sigma_mm = 0.0;  ///< Gaussian along each axis of the lattice; 0 is none
  double noise_sigma_hu = 0.0;         ///< Gaussian noise
  std::uint64_t seed = 1;
  HeadTissues tissues;
};

/// Returns a CT of the head phantom. Each sample is the mean of the closed forms over its voxel, by 8^3
/// sub-samples near surfaces and exact elsewhere; then follow blur, noise and rounding to int16. With a
/// gantry tilt the lattice is sheared: rows lie in the slices, and slices follow each other along z. Throws
/// std::invalid_argument that names the option out of its range; voxel::Stopped. Parallel; same bits on any
/// thread count. Cost: about five seconds of processor time at 1 mm, proportional to the number of voxels at
/// the surface.
voxel::Scene head_phantom(const HeadOptions& options = {}, const voxel::Progress& progress = {});

/// Parts of the head's closed form. Bone is all bone and teeth, with the mandible; Skin is everything inside
/// the skin's surface.
enum class HeadPart { Bone, Mandible, Teeth, Skin };
/// Whether a point, in LPS millimetres, is inside a part of the closed form.
bool head_contains(HeadPart part, const glm::dvec3& p_mm);
/// A box in LPS millimetres that holds the whole head and headrest. Its sides are at even millimetres; planes
/// at whole millimetres lie between the voxels of a 1 mm scan.
voxel::Box head_bounds();

}  // namespace octotomy::verify
