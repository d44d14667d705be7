// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/edge_tree.h"
#include "voxel/space/view.h"

namespace octotomy::voxel {

/// A volume of interest from regions drawn on parallel slices (thesis 6.2.1.3). On a slice the object is the
/// inside of its polygons, by the even-odd rule. Each slice represents half the gap to each neighbour; the
/// first and last extend equally far beyond the stack. In combine(), a voxel centre on a border is inside at
/// the border's lower end only.
struct SliceMask {
  struct Slice {
    double position_mm = 0.0;                          ///< p . look for the points p of its plane
    std::vector<std::vector<glm::dvec2>> polygons_mm;  ///< in the view's millimetres; without any, the slice
                                                       ///< is empty
  };
  /// Rule between two slices that are not empty. Nearest: the region of the nearer slice. ShapeBased: the
  /// points at which the distances to the two outlines, negative inside and weighted by nearness, sum to at
  /// most zero (shape-based interpolation, Raya and Udupa, IEEE Trans. Medical Imaging 9, 1990, with exact
  /// distances). Next to an empty slice, both use the region of the nearer slice.
  enum class Between { ShapeBased, Nearest };

  View view;
  std::vector<Slice> slices;  ///< at least two, positions ascending
  Between between = Between::ShapeBased;
};

/// Throws std::invalid_argument that names the slice and polygon: fewer than two slices, positions that do
/// not ascend or all lie within 0.01 mm, no polygon at all, or a polygon that check(RegionMask) rejects.
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
  /// across it. If both are zero the value is exact and low equals high. Cost: that of the slices within
  /// reach.
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
