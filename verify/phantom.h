// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>

#include "voxel/scene.h"

namespace octotomy::verify {

/// Hounsfield values of the head phantom. Bone and soft tissue are chosen so that the half level, where a
/// voxel is half bone, is exactly 300 HU: a window from 300 digitises the closed form without bias wherever
/// bone borders soft tissue, and everywhere else bone is lined by it.
struct HeadTissues {
  double air = -1000.0;
  double soft = 40.0;
  double bone = 560.0;
  double tooth_core =
      1800.0;  ///< at least two millimetres within a tooth's surface, which has the value of bone
  double headrest = -150.0;
};

/// How the head is scanned. Frame: LPS millimetres; x = 0 is the median plane, the Frankfurt plane is
/// z = -6, the ear canals lie at y = 6; the maxilla lies about (0, -60, -42), the crown at z = 107. The
/// patient's left carries an exostosis at the angle of the mandible, about (53, -17, -70), the right does
/// not.
struct HeadOptions {
  double voxel_mm = 1.0;
  std::optional<double> slice_mm;      ///< slice spacing; default voxel_mm
  double gantry_tilt_deg = 0.0;        ///< slices tilted about the patient's x axis
  double point_spread_sigma_mm = 0.0;  ///< Gaussian along each axis of the lattice; 0 is none
  double noise_sigma_hu = 0.0;         ///< Gaussian noise
  std::uint64_t seed = 1;
  HeadTissues tissues;
};

/// A CT of the head phantom: every voxel the mean over its cuboid of the closed forms, by 8^3 sub-samples
/// where a surface may pass, exactly elsewhere, then blurred, made noisy, rounded to int16. With a gantry
/// tilt the lattice is that of the scan, sheared: rows lie in the slices, slices follow each other along z.
/// Throws std::invalid_argument naming the option that is out of its range. Parallel; same bits on any thread
/// count. Cost: about five seconds of processor time at 1 mm, growing with the surface in voxels.
voxel::Scene head_phantom(const HeadOptions& options = {});

/// Parts of the head's closed form.
enum class HeadPart { Bone, Mandible, Teeth, Skin };
/// Whether a point, LPS millimetres, is inside the closed form. Bone is all bone and teeth, the mandible's
/// included; Skin is everything within the skin's surface.
bool head_contains(HeadPart part, const glm::dvec3& p_mm);
/// A box that holds the whole head and headrest; its edges are whole, even millimetres, and planes at whole
/// millimetres lie between the voxels of a 1 mm scan.
voxel::Box head_bounds();

/// A volume by regular sampling of a predicate, with the standard error of that method on curved boundary.
struct SampledVolume {
  double volume_mm3 = 0.0;
  double standard_error_mm3 = 0.0;
};
/// Samples a box at cell centres of edge `step_mm`, less where the box is not a whole number of steps. Throws
/// std::invalid_argument where the step or the box has no size. Error: 0.3 step^2 sqrt(S), S the boundary's
/// area estimated from the same samples. Parallel; same bits on any thread count.
SampledVolume sample_volume(const voxel::Box& box, double step_mm,
                            const std::function<bool(const glm::dvec3&)>& inside);

}  // namespace octotomy::verify
