// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "voxel/drawn.h"
#include "voxel/view.h"

namespace octotomy::voxel {

/// What a picture spans, in the view's millimetres.
struct Frame {
  glm::dvec2 centre_mm{0.0};
  double width_mm = 1.0;
};

/// The square about the objects' extents as the view shows them, a twentieth wider, in the middle of a
/// picture of the given size; about the universe where all objects are empty.
/// Precondition: one object at least, all of one universe. Cost: the boundary of the extents.
Frame frame_about(const std::vector<Drawn>& objects, const View& view, const glm::ivec2& size_px);

/// An observer at a finite distance. The plane across the middle of what is seen is shown as an orthographic
/// picture shows it; what is nearer is larger.
struct Eye {
  double distance_mm = 600.0;  ///< from that plane, above 0
  double plane_mm = 0.0;       ///< depth of that plane

  double depth_mm() const { return plane_mm - distance_mm; }
  /// What a length at a depth is shown larger by, turned over. Depths of the eye and before have none.
  double spread(double at_mm) const { return (at_mm - depth_mm()) / distance_mm; }
};

/// The plane that a picture lies in: perpendicular to look, through the nearest corner of the
/// universe's bounding box, where depth is 0. A pixel position has (0, 0) at the picture's top left corner, x
/// to the right and y down; pixel (i, j) has its centre at (i + 1/2, j + 1/2).
struct ImagePlane {
  View view;
  glm::ivec2 size_px{0};
  glm::dvec2 centre_mm{0.0};
  double pixel_mm = 1.0;
  double nearest_mm = 0.0;      ///< p . look of the points of depth 0
  double depth_range_mm = 0.0;  ///< depth of the universe's farthest corner
  std::optional<Eye> eye{};     ///< none: orthographic

  /// Where a pixel position lies in the view's millimetres; seen by an eye, at the eye's plane.
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
/// The same plane seen by an eye that is as far from the middle of the universe.
ImagePlane seen_from(ImagePlane plane, double eye_distance_mm);

/// The rays of an image plane in the universe's index space: the point of pixel position p at a depth is
/// start(p) + depth direction(p), both linear in p; of an orthographic plane all directions are per_mm.
/// Components of per_mm that do not move a ray by a noticeable part of a voxel on its way through the
/// universe are exactly zero.
struct VoxelRays {
  glm::dvec3 first{0.0};
  glm::dvec3 per_px_x{0.0};
  glm::dvec3 per_px_y{0.0};
  glm::dvec3 per_mm{0.0};
  glm::dvec3 per_mm_px_x{0.0};  ///< by which directions differ
  glm::dvec3 per_mm_px_y{0.0};

  glm::dvec3 direction(const glm::dvec2& p_px) const {
    return per_mm + p_px.x * per_mm_px_x + p_px.y * per_mm_px_y;
  }
  glm::dvec3 start(const glm::dvec2& p_px) const { return first + p_px.x * per_px_x + p_px.y * per_px_y; }
};
VoxelRays voxel_rays(const Universe& universe, const ImagePlane& plane);

/// How a view runs along the universe's axes. Entries are right, up, look.
struct AxisView {
  std::array<int, 3> axis{0, 1, 2};
  std::array<bool, 3> reversed{false, false, false};  ///< the index falls along that direction
};
/// None where the view is not along the axes, or the axes are not perpendicular.
std::optional<AxisView> axis_view(const Universe& universe, const View& view);

}  // namespace octotomy::voxel
