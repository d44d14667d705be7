// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::verify {

/// How the head phantom's teeth are scanned from within the mouth.
struct ToothScanPhantomOptions {
  bool is_upper = true;
  double spacing_mm = 0.3;  ///< approximate distance between neighbouring points of the scan
  double noise_mm = 0.05;   ///< standard deviation of each point along its normal
  /// The displacement of the arch's ends, in a random direction across the arch. The arch's middle does not
  /// move.
  double bend_mm = 0.1;
  int holes = 8;  ///< number of holes, round, with a radius of 0.7 to 2 mm
  /// The standard deviation of `points_mm` along each axis, which imitates points placed by hand.
  double hand_mm = 0.4;
  std::uint64_t seed = 1;
};

/// An open scan of one row of teeth with some of the gum, in a random pose.
struct ToothScanPhantom {
  brep::Triangles scan;
  /// The scan's points on the closed form of teeth and gum, in LPS millimetres: their positions without
  /// noise, bend and pose.
  std::vector<glm::dvec3> truth_mm;
  glm::dmat4 lps_from_scan{1.0};  ///< the pose
  /// Seven places on biting surfaces along the arch, from right to left: in the scan's frame, and in LPS.
  /// Both have random errors.
  std::vector<glm::dvec3> scan_points_mm, points_mm;
};

/// Scans a row of teeth. The gum's surface lies 1.2 mm outside the bone and ends at most 10 mm from the tips.
/// Throws std::invalid_argument if the spacing is not above 0. Same bits on any number of threads. Cost: a
/// second of processor time at the first call for a row and a spacing.
ToothScanPhantom tooth_scan_phantom(const ToothScanPhantomOptions& options = {});

}  // namespace octotomy::verify
