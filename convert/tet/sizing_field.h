// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "brep/mesh/distance.h"
#include "brep/mesh/triangles.h"
#include "convert/tet/tetrahedra.h"

namespace octotomy::convert {

/// A place of finer elements: about landmarks, or along a surface. tetrahedralise() refines from the solid's
/// surface inward, so only smooth_tetrahedra_of() refines at places deep inside.
struct Refinement {
  std::vector<glm::dvec3> points_mm;
  brep::Triangles surface{};  ///< may be open; no triangles: refines about the points only
  double size_mm = 1.0;       ///< approximate largest side of a surface's triangles there
};

/// Growth of elements' sides per length away from a refinement: the largest that Mesh_3 and a radius-edge
/// bound allow without flat elements in between.
constexpr double sizing_growth() {
  return 0.3;
}

/// The largest side of elements at any point.
class SizingField {
 public:
  /// Throws std::invalid_argument if a size is not positive, or a refinement has neither points nor
  /// triangles.
  explicit SizingField(const std::vector<Refinement>& finer);

  /// For each point, the smallest size that a refinement allows there: its size plus the growth over the
  /// distance from it. Infinite if there are no refinements. Parallel. Cost a point: the landmarks, and log n
  /// of a surface's triangles.
  std::vector<double> at_mm(const std::vector<glm::dvec3>& points_mm) const;
  /// The smallest size of all refinements.
  double least_mm() const { return least_mm_; }

 private:
  struct SizeSource {
    std::vector<glm::dvec3> points_mm;
    std::shared_ptr<const brep::SurfaceTree> surface;
    double size_mm = 1.0;
  };
  std::vector<SizeSource> places_;
  double least_mm_ = std::numeric_limits<double>::infinity();
};

/// The same surface with smaller triangles at refinements. Sides longer than 4/3 of the size at their middles
/// are halved, the longest of a triangle first, so that angles stay above half of the smallest former angle
/// (Rivara 1984). Points keep their numbers and new ones follow. Faces keep their planes and winding, so a
/// closed surface stays closed and keeps its volume. Throws voxel::Error (Resource) beyond four million
/// triangles. Cost: n log n of the answer.
brep::Triangles refined_surface(const brep::Triangles& surface, const SizingField& sizes);

/// Describes places where elements are more than three times the size that a refinement allows at their
/// middle, which happens deep inside a refined surface: the worst place, its size and the requested size, and
/// the number of places. Checks the element nearest to each point, and to a hundred points of a surface. None
/// if there is no such place. Cost: places times elements, parallel.
std::optional<std::string> coarse_place(const Tetrahedra& tetrahedra, const std::vector<Refinement>& finer);

}  // namespace octotomy::convert
