// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "brep/distance.h"
#include "brep/triangles.h"

namespace octotomy::convert {

/// Where elements are to be finer than elsewhere: about landmarks, or along a surface. What fills a solid
/// from its surface divides that, so that places deep within it are seen by smooth_tetrahedra_of() alone.
struct Finer {
  std::vector<glm::dvec3> points_mm;
  brep::Triangles surface{};  ///< may be open; none where there are no triangles
  double size_mm = 1.0;       ///< of the sides of a surface's triangles there, at most about
};

/// By how much elements' sides grow over a length away from where they are fine: what Mesh_3 and quality by
/// radius and edge allow without flat elements between.
constexpr double finer_growth() {
  return 0.3;
}

/// The largest sides that elements may have at any point.
class FinerSizes {
 public:
  /// Throws std::invalid_argument where a size is not positive or a place is none.
  explicit FinerSizes(const std::vector<Finer>& finer);

  /// Of each point, the least of all places' sizes, grown with the way from them; infinite where there are no
  /// places. Parallel. Cost: the landmarks, and log n of a surface's triangles, a point.
  std::vector<double> at_mm(const std::vector<glm::dvec3>& points_mm) const;
  /// The smallest of all places.
  double least_mm() const { return least_mm_; }

 private:
  struct Place {
    std::vector<glm::dvec3> points_mm;
    std::shared_ptr<const brep::SurfaceTree> surface;
    double size_mm = 1.0;
  };
  std::vector<Place> places_;
  double least_mm_ = std::numeric_limits<double>::infinity();
};

/// The same surface with smaller triangles where they are to be fine: sides longer than 4/3 of the size at
/// their middles are halved, the longest of a triangle first, so that angles stay over half the smallest that
/// there was (Rivara 1984). Points stay and new ones stand behind them; faces keep their planes and winding,
/// so that a closed surface stays closed and keeps its volume. Throws std::length_error where that would be
/// over four million triangles. Cost: n log n of the answer.
brep::Triangles finer_surface(const brep::Triangles& surface, const FinerSizes& sizes);

}  // namespace octotomy::convert
