// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

namespace octotomy::planner {

/// Errors of an operation that trials go through, as standard deviations; independent of each other.
struct Trials {
  double landmark_mm = 1.0;      ///< of a landmark's placement, along each axis
  double kerf_mm = 0.1;          ///< of a saw's width
  double segmentation_mm = 0.2;  ///< of where bone ends, outward everywhere alike
  double seating_mm = 0.5;       ///< of a moved piece's place, along each axis
  double seating_deg = 0.5;      ///< of its turn, about each axis through its centroid
  int trials = 10000;
  int seed = 1;
};

}  // namespace octotomy::planner
