// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace octotomy::planner {

/// Standard deviations of the errors in trials of a plan. The errors are independent of each other.
struct Trials {
  double landmark_mm = 1.0;      ///< of a landmark's position, along each axis
  double kerf_mm = 0.1;          ///< of a saw's width
  double segmentation_mm = 0.2;  ///< of the displacement of the bone's boundary, which is the same everywhere
  double seating_mm = 0.5;       ///< of a moved piece's position, along each axis
  double seating_deg = 0.5;      ///< of a moved piece's rotation about each axis through its centroid
  int trials = 10000;
  int seed = 1;
};

}  // namespace octotomy::planner
