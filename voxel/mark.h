// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/camera.h"

namespace octotomy::voxel {

// Points marked on pictures (thesis 8.3): one mark on a displayed surface is Picture::point_mm() (M1), marks
// in two views are a point anywhere in space (M2).

/// All points that one position in a picture may show, in LPS.
struct SightLine {
  glm::dvec3 start_mm{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< unit, away from the observer
};

/// The line of sight through a pixel position, from the plane of depth 0 on; (0, 0) is the picture's top left
/// corner.
SightLine sight_line(const ImagePlane& plane, const glm::dvec2& p_px);
/// The line of the points that a view shows at a position in its own millimetres.
SightLine sight_line(const View& view, const glm::dvec2& p_mm);

/// Where a picture shows a point: a pixel position, which may lie beyond its edges. Inverse of sight_line().
glm::dvec2 pixel_position(const ImagePlane& plane, const glm::dvec3& p_mm);

/// A point in space from two lines of sight: midway between their nearest points, which are miss_mm apart, so
/// half of that is the least by which the two marks contradict each other.
struct SpaceMark {
  glm::dvec3 point_mm{0.0};
  double miss_mm = 0.0;
};

/// Throws std::invalid_argument where the lines run within 5.7 degrees of each other: there an error of the
/// marks would be more than ten times as large along the lines, and views farther apart must be asked for.
SpaceMark mark_between(const SightLine& a, const SightLine& b);

}  // namespace octotomy::voxel
