// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "voxel/solid/edge_tree.h"
#include "voxel/space/view.h"

namespace octotomy::voxel {

/// A volume of interest from regions drawn on parallel slices (thesis 6.2.1.3). On a slice the object is the
/// inside of its polygons, by the even-odd rule. Each slice speaks for half the gap to its neighbours, the
/// first and last for as much beyond them. combine() counts a centre on a border at its lower end only.
struct SliceMask {
  struct Slice {
    double position_mm = 0.0;                          ///< p . look of its plane
    std::vector<std::vector<glm::dvec2>> polygons_mm;  ///< in the view's millimetres; none: empty there
  };
  /// What lies between two slices that are not empty: the nearer one's region; or the points at which the
  /// distances to the two outlines, negative inside and weighted by nearness, sum to at most zero
  /// (shape-based interpolation, Raya and Udupa, IEEE Trans. Medical Imaging 9, 1990, with exact distances).
  /// Next to an empty slice it is the nearer one's region.
  enum class Between { ShapeBased, Nearest };

  View view;
  std::vector<Slice> slices;  ///< at least two, positions ascending
  Between between = Between::ShapeBased;
};

/// Throws std::invalid_argument saying which slice and polygon: fewer than two slices, positions that do not
/// ascend, nothing drawn at all, and what check(RegionMask) refuses.
void check(const SliceMask& mask);

/// The mask ready to be asked about points: distances to polygons are exact. Precondition: the mask passes
/// check() and outlives this. Building: n log n in the edges, of which it keeps a copy.
class SliceDistance {
 public:
  explicit SliceDistance(const SliceMask& mask);

  struct Bounds {
    double low, high;
  };
  /// Bounds of a function that is at most zero inside the mask and positive outside, over the points whose
  /// distance from (p_mm, position_mm) is at most `in_plane_mm` within the slices' plane and `across_mm`
  /// across it. Exact, low and high the same, if both are zero. Cost: that of the slices within reach.
  Bounds operator()(const glm::dvec2& p_mm, double position_mm, double in_plane_mm, double across_mm) const;

 private:
  struct Stretch {
    double from_mm, to_mm;
  };
  Bounds in_gap(std::size_t below, double at_below, double at_above, const Stretch& stretch) const;
  double distance_mm(std::size_t slice, const glm::dvec2& p_mm) const;

  const SliceMask* mask_;
  std::vector<EdgeTree> edges_;  ///< of each slice
};

}  // namespace octotomy::voxel
