// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "voxel/view/camera.h"

namespace octotomy::voxel {

// Points marked on pictures (thesis 8.3): one mark on a displayed surface determines the point
// Picture::point_mm() (M1); marks in two views determine a point anywhere in space (M2).

/// The line of all points that project onto one position in a picture, in LPS.
struct SightLine {
  glm::dvec3 start_mm{0.0};
  glm::dvec3 direction{0.0, 1.0, 0.0};  ///< unit vector away from the observer
};

/// The line of sight through a pixel position. It starts on the plane of depth 0; (0, 0) is the picture's top
/// left corner.
SightLine sight_line(const ImagePlane& plane, const glm::dvec2& p_px);
/// The line of sight through a position in the view's millimetres.
SightLine sight_line(const View& view, const glm::dvec2& p_mm);

/// The pixel position onto which a point projects, possibly beyond the picture's edges. The inverse of
/// sight_line().
glm::dvec2 pixel_position(const ImagePlane& plane, const glm::dvec3& p_mm);

/// A point in space from two lines of sight: midway between the nearest points of the lines, which are
/// miss_mm apart. At least one of the two lines is half of miss_mm or more away from the true point.
struct SpaceMark {
  glm::dvec3 point_mm{0.0};
  double miss_mm = 0.0;
};

/// Throws std::invalid_argument if the angle between the lines is below 5.7 degrees, because along the lines
/// errors of the marks would be magnified more than tenfold.
SpaceMark mark_between(const SightLine& a, const SightLine& b);

}  // namespace octotomy::voxel
