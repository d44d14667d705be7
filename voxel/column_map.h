// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "voxel/camera.h"
#include "voxel/depth_image.h"
#include "voxel/drawn.h"
#include "voxel/ray_surface.h"

namespace octotomy::voxel {

/// What an observer along one of the universe's axes sees in every column of voxels: the thesis's quadtree
/// image at its full resolution. A picture of any pixel size samples it.
struct ColumnMap {
  int side = 0;               ///< columns along each of the image's axes
  glm::dvec2 spacing_mm{1};   ///< between columns, along right and up
  std::vector<Seen> columns;  ///< column (i, j) is entry i + side j; i, j are universe indices along the
                              ///< axes of right and up, whichever way these run

  /// Column (i, j). Precondition: 0 <= i, j < side.
  const Seen& at(int i, int j) const {
    return columns[static_cast<std::size_t>(j) * static_cast<std::size_t>(side) +
                   static_cast<std::size_t>(i)];
  }
  /// What is seen between columns; integers are the columns' centres. Whether something is seen, and which
  /// object, is the nearest column's answer; depth is bilinear among the columns that continue its surface,
  /// so that it neither steps on smooth surfaces nor smears over breaks. Outside the map: background.
  Seen seen(const glm::dvec2& column) const;
};

/// The picture of a map: what seen() says at every pixel's centre, to the precision of float. Precondition:
/// rays of the view that the axes are of. Parallel over rows.
DepthImage picture_of(const ColumnMap& map, const AxisView& axes, const VoxelRays& rays,
                      const glm::ivec2& size_px);

/// Finds an object's surface in columns. Refers to the object.
class ColumnSurface {
 public:
  ColumnSurface(const Drawn& object, const AxisView& axes);

  /// What is seen in a column whose first voxel lies `before` voxels behind the universe's front face. With
  /// Drawn::grey its depth is where the threshold is crossed between the centre of the last voxel outside and
  /// the first inside (thesis 5.2.2.2), also where the node before is a partial one, for it is the voxel
  /// before that counts; where the samples do not cross the threshold, the object was cut there and the
  /// voxel's face stays.
  Seen seen(const glm::ivec2& column, int before) const;

 private:
  glm::ivec3 voxel(const glm::ivec2& column, int before) const;
  std::optional<Seen> seen_moved(const glm::ivec2& column, int before) const;

  const Drawn& object_;
  AxisView axes_;
  double spacing_mm_ = 1.0;           ///< along the look axis
  std::optional<GreySurface> moved_;  ///< of an object away from its samples
};

/// The map of several objects' columns: the nearest wins, the first object listed where several are equally
/// near. `before[o]` are the numbers of voxels before the first one of object o, -1 where there is none, by
/// column. Parallel over rows.
ColumnMap column_map(const std::vector<Drawn>& objects, const AxisView& axes,
                     const std::vector<std::vector<std::int32_t>>& before);

}  // namespace octotomy::voxel
