// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace octotomy::brep {

/// An observer at a finite distance. One plane across the scene is in true scale; nearer parts look larger.
struct Observer {
  double distance_mm = 600.0;  ///< from the plane in true scale, above 0
  double plane_mm = 0.0;       ///< depth of the plane in true scale

  double depth_mm() const { return plane_mm - distance_mm; }
};

/// A picture's plane. Directions are unit LPS vectors, right = look x up. Pixel positions count from the top
/// left corner, y down; pixel (i, j) has its centre at (i + 1/2, j + 1/2).
struct Camera {
  glm::dvec3 right{1, 0, 0}, up{0, 0, 1}, look{0, 1, 0};
  glm::ivec2 size_px{512, 512};
  glm::dvec2 centre_mm{0.0};         ///< (p . right, p . up) of the picture's centre
  double pixel_mm = 1.0;             ///< edge of a pixel, in the plane in true scale
  double nearest_mm = 0.0;           ///< p . look of the points of depth 0
  std::optional<Observer> observer;  ///< none: orthographic

  /// The inverse of the magnification at a depth: 0 at the observer, negative behind.
  double spread(double depth_mm) const {
    return observer ? (depth_mm - observer->depth_mm()) / observer->distance_mm : 1.0;
  }
  double depth_mm(const glm::dvec3& p_mm) const { return glm::dot(p_mm, look) - nearest_mm; }
  /// The pixel position that shows a point. Precondition: the point is in front of the observer.
  glm::dvec2 position_px(const glm::dvec3& p_mm) const {
    const glm::dvec2 p(glm::dot(p_mm, right), glm::dot(p_mm, up));
    const glm::dvec2 aside = (p - centre_mm) / (spread(depth_mm(p_mm)) * pixel_mm);
    return glm::dvec2(size_px) * 0.5 + glm::dvec2(aside.x, -aside.y);
  }
  /// The point that a pixel position shows at a depth. Inverse of position_px().
  glm::dvec3 lps_mm(const glm::dvec2& p_px, double at_mm) const {
    const glm::dvec2 from_centre = (p_px - glm::dvec2(size_px) * 0.5) * (pixel_mm * spread(at_mm));
    const glm::dvec2 p = centre_mm + glm::dvec2(from_centre.x, -from_centre.y);
    return right * p.x + up * p.y + look * (nearest_mm + at_mm);
  }
};

}  // namespace octotomy::brep
