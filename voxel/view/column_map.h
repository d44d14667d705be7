// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cassert>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/view/camera.h"
#include "voxel/view/depth_image.h"
#include "voxel/view/drawn_object.h"
#include "voxel/view/ray_surface.h"

namespace octotomy::voxel {

/// The visible surface in every column of voxels along one of the universe's axes: the thesis's quadtree
/// image at full resolution. Pictures of any pixel size are sampled from this map.
struct ColumnMap {
  int side = 0;               ///< columns along each of the image's axes
  glm::dvec2 spacing_mm{1};   ///< between columns, along right and up
  std::vector<Seen> columns;  ///< column (i, j) is entry i + side j; i, j are universe indices along the
                              ///< axes of right and up, which may run either way

  /// Column (i, j). Precondition: 0 <= i, j < side.
  const Seen& at(int i, int j) const {
    assert(i >= 0 && i < side && j >= 0 && j < side);
    return columns[static_cast<std::size_t>(j) * static_cast<std::size_t>(side) +
                   static_cast<std::size_t>(i)];
  }
  /// The visible surface at a position between columns; integers are the columns' centres. The object is the
  /// nearest column's. Depth is bilinear between the columns that continue the nearest column's surface, so a
  /// smooth surface has no steps and a break is not smeared. Outside the map: background.
  Seen seen(const glm::dvec2& column) const;
};

/// The picture of a map: seen() at every pixel's centre, to the precision of float. Precondition: the rays
/// and axes are of one view. Parallel over rows.
DepthImage picture_of(const ColumnMap& map, const AxisView& axes, const VoxelRays& rays,
                      const glm::ivec2& size_px);

/// Finds an object's surface in columns. Refers to the object.
class ColumnSurface {
 public:
  ColumnSurface(const DrawnObject& object, const AxisView& axes);

  /// The surface in a column whose first voxel lies `before` voxels behind the universe's front face. With
  /// DrawnObject::grey its depth is the crossing of the threshold between the centres of the last voxel
  /// outside and the first inside (thesis 5.2.2.2). Departure from the thesis: uses the voxel before the
  /// first voxel inside, not the node before it. If these samples do not cross the threshold, the object was
  /// cut there, and the depth is that of the voxel's face.
  Seen seen(const glm::ivec2& column, int before) const;

 private:
  glm::ivec3 voxel(const glm::ivec2& column, int before) const;
  std::optional<Seen> seen_moved(const glm::ivec2& column, int before) const;

  const DrawnObject& object_;
  AxisView axes_;
  double spacing_mm_ = 1.0;           ///< along the look axis
  std::optional<GreySurface> moved_;  ///< only for an object that was moved away from its samples
};

/// The map of several objects' columns: the nearest surface wins; at equal depth, that of the first object.
/// `before[o]` holds, by column, the number of voxels before the first of object o, or -1. Parallel over
/// rows.
ColumnMap column_map(const std::vector<DrawnObject>& objects, const AxisView& axes,
                     const std::vector<std::vector<std::int32_t>>& before);

}  // namespace octotomy::voxel
