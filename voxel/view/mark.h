// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/view/camera.h"

namespace octotomy::voxel {

// Points marked on pictures (thesis 8.3): one mark on a displayed surface gives Picture::point_mm() (M1);
// marks in two views give a point anywhere in space (M2).

/// The line of points that one position in a picture shows, in LPS.
struct SightLine {
  glm::dvec3 start_mm{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< unit, away from the observer
};

/// The line of sight through a pixel position. It starts on the plane of depth 0; (0, 0) is the picture's top
/// left corner.
SightLine sight_line(const ImagePlane& plane, const glm::dvec2& p_px);
/// The line of sight through a position in the view's millimetres.
SightLine sight_line(const View& view, const glm::dvec2& p_mm);

/// The pixel position, possibly beyond the picture's edges, that shows a point. Inverse of sight_line().
glm::dvec2 pixel_position(const ImagePlane& plane, const glm::dvec3& p_mm);

/// A point in space from two lines of sight: midway between the nearest points of the lines, which are
/// miss_mm apart. At least one of the two marks is off by half of miss_mm or more.
struct SpaceMark {
  glm::dvec3 point_mm{0.0};
  double miss_mm = 0.0;
};

/// Throws std::invalid_argument if the angle between the lines is under 5.7 degrees, because an error of the
/// marks would grow more than tenfold along the lines.
SpaceMark mark_between(const SightLine& a, const SightLine& b);

}  // namespace octotomy::voxel
