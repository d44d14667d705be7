// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "brep/mesh/triangles.h"
#include "convert/tet/tetrahedra.h"
#include "verify/witness/reading.h"
#include "verify/witness/reshaped_witness.h"
#include "verify/witness/triangle_grid.h"

namespace octotomy::verify {

/// The displacements of tetrahedra's nodes as a field over space. Within an element the field is linear.
/// Outside all elements it is that of a point of their surface: the one nearest to a place 1e-6 (1, 0.618,
/// 0.382) mm away. At a distance d from the box of all nodes the field is multiplied by (1 - r)^4 (4 r + 1)
/// with r = d / fade_mm; beyond fade_mm it is zero. No kernel shares this code. LPS millimetres.
class NodeMotion {
 public:
  /// Throws std::invalid_argument without elements, or unless each node has one displacement.
  NodeMotion(const convert::Tetrahedra& elements, std::vector<glm::dvec3> displacement_mm, double fade_mm);

  glm::dvec3 displacement_mm(const glm::dvec3& p_mm) const;
  /// Whether the displacements turn an element inside out. Points then may have several origins.
  bool turns_over() const;
  /// The point that the field moves to `p_mm`: x = p - u(x), repeated until x no longer changes. None if the
  /// iteration does not converge, for example where elements stretch or shear by their own length.
  std::optional<glm::dvec3> origin_mm(const glm::dvec3& p_mm) const { return origin_mm(p_mm, p_mm); }
  /// The point that the field moves to `p_mm`. The iteration starts at `guess_mm`.
  std::optional<glm::dvec3> origin_mm(const glm::dvec3& p_mm, const glm::dvec3& guess_mm) const;

 private:
  std::vector<glm::dvec3> nodes_mm_, displacement_mm_;
  double fade_mm_;
  glm::dvec3 low_mm_, high_mm_;  ///< corners of the nodes' box
  std::vector<std::array<std::uint32_t, 4>> tets_;
  BoxGrid cells_;
  std::optional<TriangleGrid> surface_;  ///< surface of all elements; its points are all nodes
};

/// The expected surface of an object whose points move as NodeMotion states. The reach is the rounding of
/// displacements.
ReshapedSurface surface_warped(const brep::Triangles& still, const NodeMotion& motion);

/// A witness of an object that moved with a field: at a point, the still object's witness at the origin of
/// that point. Triangles stay flat between moved points; the witness allows the resulting error, which is
/// measured at three points of each side and in the middle of each triangle. Where a point has no origin, any
/// answer is allowed. Empty where the still object has no witness, or if an element is inverted.
Witness witness_of_warped(Witness still, const brep::Triangles& still_surface,
                          std::shared_ptr<const NodeMotion> motion);

}  // namespace octotomy::verify
