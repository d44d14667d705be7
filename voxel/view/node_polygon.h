// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "voxel/view/camera.h"

namespace octotomy::voxel {

/// The convex polygons of octree nodes in one orthographic view (thesis 4.4.3.1): intersections of half
/// planes a x + b y + c >= 0, two for each axis, across the axis's image. There are six in general views and
/// four in views along an axis. a and b are the same for all nodes; c follows from centre and edge.
class NodePolygons {
 public:
  NodePolygons(const Universe& universe, const ImagePlane& plane)
      : rays_(voxel_rays(universe, plane)),
        image_from_voxel_(glm::inverse(glm::dmat3(rays_.per_px_x, rays_.per_px_y, rays_.per_mm))) {
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec2 along(image_from_voxel_[axis]);
      half_extent_px_ += 0.5 * glm::abs(along);
      // An axis along the view has no extent in the image, so its pair of half planes would exclude nothing.
      if (rays_.per_mm[axis] != 0.0 && still_axes() == 2) continue;
      const glm::dvec2 across(-along.y, along.x);
      double half_width = 0.0;
      for (int other = 0; other < 3; ++other)
        half_width += 0.5 * std::abs(glm::dot(across, glm::dvec2(image_from_voxel_[other])));
      pairs_[static_cast<std::size_t>(pair_count_++)] = {across, half_width};
    }
    for (int axis = 0; axis < 3; ++axis) {
      rises_[axis] = rays_.per_mm[axis] > 0.0;
      mm_per_voxel_[axis] = rays_.per_mm[axis] == 0.0 ? 0.0 : 1.0 / rays_.per_mm[axis];
    }
  }

  /// A node's polygon.
  struct Polygon {
    glm::dvec2 centre_px{0.0};
    glm::dvec2 half_px{0.0};      ///< of the bounding rectangle
    double edge = 1.0;            ///< edge of the node, in voxels
    glm::dvec3 enter_voxel{0.0};  ///< for each axis, the position of the plane through which rays enter
  };
  /// The polygon of the cube of `edge` voxels a side whose first voxel is `origin`.
  Polygon of(const glm::ivec3& origin, int edge) const {
    const glm::dvec3 low = glm::dvec3(origin) - 0.5;
    const glm::dvec3 centre = low + 0.5 * edge;
    Polygon polygon{glm::dvec2(image_from_voxel_ * (centre - rays_.first)), half_extent_px_ * double(edge),
                    double(edge), low};
    for (int axis = 0; axis < 3; ++axis)
      if (!rises_[axis]) polygon.enter_voxel[axis] += edge;
    return polygon;
  }

  bool holds(const Polygon& polygon, const glm::dvec2& p_px) const {
    const glm::dvec2 d = p_px - polygon.centre_px;
    for (int i = 0; i < pair_count_; ++i) {
      const Pair& pair = pairs_[static_cast<std::size_t>(i)];
      if (std::abs(glm::dot(pair.across, d)) > pair.half_width * polygon.edge) return false;
    }
    return true;
  }
  /// Whether a square of pixel positions lies wholly inside or wholly outside the polygon. Conservative:
  /// Either may also be returned for a square that lies on one side.
  enum class Containment { Inside, Outside, Either };
  Containment place(const Polygon& polygon, const glm::dvec2& low_px, double side_px) const {
    const glm::dvec2 d = low_px + 0.5 * side_px - polygon.centre_px;
    if (glm::any(glm::greaterThan(glm::abs(d), polygon.half_px + 0.5 * side_px))) return Containment::Outside;
    bool inside = true;
    for (int i = 0; i < pair_count_; ++i) {
      const Pair& pair = pairs_[static_cast<std::size_t>(i)];
      const double distance = std::abs(glm::dot(pair.across, d));
      const double reach = 0.5 * side_px * (std::abs(pair.across.x) + std::abs(pair.across.y));
      if (distance - reach > pair.half_width * polygon.edge) return Containment::Outside;
      inside = inside && distance + reach <= pair.half_width * polygon.edge;
    }
    return inside ? Containment::Inside : Containment::Either;
  }
  /// The depth at which the ray of a pixel position enters the node. Precondition: the node's polygon
  /// contains the position.
  double depth_mm(const Polygon& polygon, const glm::dvec2& p_px) const {
    const glm::dvec3 start = rays_.start(p_px);
    double depth = -std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
      if (mm_per_voxel_[axis] != 0.0)
        depth = std::max(depth, (polygon.enter_voxel[axis] - start[axis]) * mm_per_voxel_[axis]);
    return depth;
  }

  /// The number of the front child. Child i from the front has the number i ^ front_child().
  int front_child() const { return int{!rises_.x} | (int{!rises_.y} << 1) | (int{!rises_.z} << 2); }

 private:
  int still_axes() const {
    return int{rays_.per_mm.x == 0.0} + int{rays_.per_mm.y == 0.0} + int{rays_.per_mm.z == 0.0};
  }
  struct Pair {
    glm::dvec2 across{0.0};
    double half_width = 0.0;  ///< half the pair's width for a node of one voxel
  };

  VoxelRays rays_;
  glm::dmat3 image_from_voxel_;
  glm::dvec2 half_extent_px_{0.0};
  std::array<Pair, 3> pairs_{};
  int pair_count_ = 0;
  glm::bvec3 rises_{true};
  glm::dvec3 mm_per_voxel_{0.0};
};

}  // namespace octotomy::voxel
