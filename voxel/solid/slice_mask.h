// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/edge_tree.h"
#include "voxel/space/view.h"

namespace octotomy::voxel {

/// A volume of interest from regions drawn on parallel slices (thesis 6.2.1.3). On a slice the object is the
/// inside of its polygons, by the even-odd rule. Each slice represents half of the gap to either neighbour;
/// the first and the last slice represent the same length beyond the stack. In combine(), a voxel centre on
/// the border of the object is inside only at the object's lower end.
struct SliceMask {
  struct Slice {
    /// Position of the slice's plane: p . look for its points p.
    double position_mm = 0.0;
    /// In the view's millimetres; without polygons the slice is empty.
    std::vector<std::vector<glm::dvec2>> polygons_mm;
  };
  /// The object between two slices that are not empty. Nearest: the region of the nearer slice. ShapeBased:
  /// the points at which the distances to the two outlines, negative inside and weighted by nearness, sum to
  /// at most zero (shape-based interpolation, Raya and Udupa, IEEE Trans. Medical Imaging 9, 1990, with exact
  /// distances). Next to an empty slice, both use the region of the nearer slice.
  enum class Between { ShapeBased, Nearest };

  View view;
  std::vector<Slice> slices;  ///< at least two, positions ascending
  Between between = Between::ShapeBased;
};

/// Throws std::invalid_argument with the slice and the polygon concerned, if there are fewer than two slices,
/// positions do not ascend or all lie within 0.01 mm, no slice has a polygon, or check(RegionMask) rejects a
/// polygon.
void check(const SliceMask& mask);

/// A function that is at most zero inside a mask; distances to polygons are exact. Precondition: the mask
/// passes check() and outlives this object. Building costs n log n in the edges, which are copied.
class SliceDistance {
 public:
  explicit SliceDistance(const SliceMask& mask);

  struct Bounds {
    double low, high;
  };
  /// Bounds of the function, at most zero inside the mask and positive outside, over the points whose
  /// distance from (p_mm, position_mm) is at most `in_plane_mm` within the slices' plane and `across_mm`
  /// across it. If both are zero, the value is exact and low equals high. Cost: a query to the edges of each
  /// slice within reach.
  Bounds operator()(const glm::dvec2& p_mm, double position_mm, double in_plane_mm, double across_mm) const;

 private:
  struct Stretch {
    double from_mm, to_mm;
  };
  Bounds in_gap(std::size_t below, double at_below, double at_above, const Stretch& stretch) const;
  double distance_mm(std::size_t slice, const glm::dvec2& p_mm) const;

  const SliceMask* mask_;
  std::vector<EdgeTree> edges_;  ///< one tree a slice
};

}  // namespace octotomy::voxel
