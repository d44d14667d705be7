// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/space/view.h"
#include "voxel/view/drawn_object.h"

namespace octotomy::voxel {

/// The frame of a picture: its centre and width, in the view's millimetres.
struct Frame {
  glm::dvec2 centre_mm{0.0};
  double width_mm = 1.0;
};

/// The frame of a picture of the given size around the objects' extents in the view, with a margin of a
/// twentieth; around the universe if all objects are empty. Precondition: there is at least one object, and
/// all have one universe. Cost: only nodes on the boundary of the extents are visited.
Frame frame_about(const std::vector<DrawnObject>& objects, const View& view, const glm::ivec2& size_px);

/// An observer at a finite distance. A plane across the scene appears in the scale of an orthographic
/// picture; parts in front of the plane appear larger.
struct Eye {
  double distance_mm = 600.0;  ///< distance from the plane in true scale, above 0
  double plane_mm = 0.0;       ///< depth of the plane in true scale

  double depth_mm() const { return plane_mm - distance_mm; }
  /// The inverse of the magnification at a depth. Precondition: the depth lies behind the eye as seen by the
  /// observer.
  double spread(double at_mm) const { return (at_mm - depth_mm()) / distance_mm; }
};

/// The plane of a picture: perpendicular to look, through the nearest corner of the universe's bounding box,
/// which has depth 0. Pixel positions count from the picture's top left corner, x to the right and y down;
/// pixel (i, j) has its centre at (i + 1/2, j + 1/2).
struct ImagePlane {
  View view;
  glm::ivec2 size_px{0};
  glm::dvec2 centre_mm{0.0};
  double pixel_mm = 1.0;
  double nearest_mm = 0.0;      ///< p . look for the points p of depth 0
  double depth_range_mm = 0.0;  ///< depth of the universe's farthest corner
  std::optional<Eye> eye{};     ///< none: orthographic

  /// Converts a pixel position to the view's millimetres; in perspective, on the plane in true scale
  /// (Eye::plane_mm).
  glm::dvec2 view_mm(const glm::dvec2& p_px) const {
    const glm::dvec2 from_centre = p_px - glm::dvec2(size_px) * 0.5;
    return centre_mm + glm::dvec2(from_centre.x, -from_centre.y) * pixel_mm;
  }
  /// The LPS point of a pixel position at a depth.
  glm::dvec3 lps_mm(const glm::dvec2& p_px, double depth_mm) const {
    const double spread = eye ? eye->spread(depth_mm) : 1.0;
    const glm::dvec2 p_mm = centre_mm + spread * (view_mm(p_px) - centre_mm);
    return view.right * p_mm.x + view.up * p_mm.y + view.look * (nearest_mm + depth_mm);
  }
};
ImagePlane image_plane(const Universe& universe, const View& view, const glm::ivec2& size_px,
                       const Frame& frame);
/// The same plane with an eye at the distance `eye_distance_mm` from the middle of the universe.
ImagePlane seen_from(ImagePlane plane, double eye_distance_mm);

/// The rays of an image plane in the universe's index space. The point of pixel position p at a depth is
/// start(p) + depth * direction(p), both linear in p; on an orthographic plane all directions are per_mm.
/// Components of per_mm that would move a ray by less than 1/64 voxel across the universe are exactly zero.
struct VoxelRays {
  glm::dvec3 first{0.0};
  glm::dvec3 per_px_x{0.0};
  glm::dvec3 per_px_y{0.0};
  glm::dvec3 per_mm{0.0};
  glm::dvec3 per_mm_px_x{0.0};  ///< change of the direction from one pixel to the next
  glm::dvec3 per_mm_px_y{0.0};

  glm::dvec3 direction(const glm::dvec2& p_px) const {
    return per_mm + p_px.x * per_mm_px_x + p_px.y * per_mm_px_y;
  }
  glm::dvec3 start(const glm::dvec2& p_px) const { return first + p_px.x * per_px_x + p_px.y * per_px_y; }
};
VoxelRays voxel_rays(const Universe& universe, const ImagePlane& plane);

/// Which axes of the universe are parallel to a view's right, up and look, in this order.
struct AxisView {
  std::array<int, 3> axis{0, 1, 2};
  /// Whether the axis's index decreases along the direction.
  std::array<bool, 3> reversed{false, false, false};
};
/// The universe's axes in a view. None if the view's directions are not parallel to the axes, or the axes are
/// not perpendicular.
std::optional<AxisView> axis_view(const Universe& universe, const View& view);

}  // namespace octotomy::voxel
