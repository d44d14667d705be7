// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/camera.h"
#include "voxel/depth_image.h"
#include "voxel/drawn.h"

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

/// Traces the objects along the view's look (thesis 4.5), the nearest voxel of any object winning and the
/// first object listed where several hold it. With Drawn::grey the depth lies where the threshold is crossed
/// between the centre of the last voxel outside and the first inside (thesis 5.2.2.2); where the samples do
/// not cross it, the object was cut there and the voxel's face stays.
/// Precondition: all objects are of one universe, for which axis_view() gave the axes.
/// Parallel over tiles of 64 x 64 columns; same bits on any thread count. Cost: the visible boundary.
ColumnMap node_trace(const std::vector<Drawn>& objects, const AxisView& axes);

}  // namespace octotomy::voxel
