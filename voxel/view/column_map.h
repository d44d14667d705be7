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
  int side = 0;              ///< number of columns along each of the image's axes
  glm::dvec2 spacing_mm{1};  ///< distance between columns, along right and up
  /// Column (i, j) is entry i + side j; i, j are universe indices along the axes of right and up, which may
  /// run either way.
  std::vector<Seen> columns;

  /// The surface in column (i, j). Precondition: 0 <= i, j < side.
  const Seen& at(int i, int j) const {
    assert(i >= 0 && i < side && j >= 0 && j < side);
    return columns[static_cast<std::size_t>(j) * static_cast<std::size_t>(side) +
                   static_cast<std::size_t>(i)];
  }
  /// The visible surface at a position between columns; integers are the columns' centres. The object is that
  /// of the nearest column. Depth is interpolated bilinearly between the columns that continue the nearest
  /// column's surface, so that a smooth surface has no steps and an edge is not blurred. Outside the map the
  /// result is background.
  Seen seen(const glm::dvec2& column) const;
};

/// The picture of a map: seen() at every pixel's centre, in single precision. Precondition: the rays and axes
/// belong to one view. Parallel over rows.
DepthImage picture_of(const ColumnMap& map, const AxisView& axes, const VoxelRays& rays,
                      const glm::ivec2& size_px);

/// Computes the depth of an object's surface in columns. Refers to the object, which must outlive it.
class ColumnSurface {
 public:
  ColumnSurface(const DrawnObject& object, const AxisView& axes);

  /// The surface in a column in which `before` voxels lie between the universe's front face and the object's
  /// first voxel. With DrawnObject::grey its depth is the crossing of the threshold between the centres of
  /// the last voxel outside and the first inside (thesis 5.2.2.2). Departure from the thesis: uses the voxel
  /// before the first voxel inside, not the node before it. If the samples at these two voxels do not cross
  /// the threshold, the object was cut there, and the depth is that of the voxel's face.
  Seen seen(const glm::ivec2& column, int before) const;

 private:
  glm::ivec3 voxel(const glm::ivec2& column, int before) const;
  std::optional<Seen> seen_moved(const glm::ivec2& column, int before) const;

  const DrawnObject& object_;
  AxisView axes_;
  double spacing_mm_ = 1.0;           ///< along the look axis
  std::optional<GreySurface> moved_;  ///< used only for an object that was moved away from its samples
};

/// The map of several objects' columns: the nearest surface wins; at equal depth, that of the first object.
/// `before[o]` contains for each column the number of voxels in front of the first voxel of object o, or -1
/// if there is none. Parallel over rows.
ColumnMap column_map(const std::vector<DrawnObject>& objects, const AxisView& axes,
                     const std::vector<std::vector<std::int32_t>>& before);

}  // namespace octotomy::voxel
