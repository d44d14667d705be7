// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// The nearest point of an oriented surface, with a signed distance.
struct SignedFoot {
  glm::dvec3 p_mm{0.0};      ///< the surface's nearest point
  glm::dvec3 normal{0.0};    ///< outward unit normal there; zero if the triangles around it have no area
  double distance_mm = 0.0;  ///< negative inside
  bool on_border = false;    ///< the foot lies on a boundary edge, where the sign is a guess
};

/// A copy of a mesh's surface that computes signed distances of points. The sign comes from the normal at the
/// nearest point: the triangle's normal or, on an edge or vertex, the sum of the adjacent triangles' unit
/// normals weighted by their angles. This sign is correct if the surface is closed. Open surfaces are
/// allowed; see `on_border`. Points in LPS millimetres. Building: n log n, about 250 bytes per triangle.
/// Source: Baerentzen and Aanaes, "Signed distance computation using the angle weighted pseudonormal", TVCG
/// 11(3), 2005.
class OrientedSurface {
 public:
  explicit OrientedSurface(const Mesh& mesh);
  explicit OrientedSurface(const Linked& linked);
  ~OrientedSurface();
  OrientedSurface(OrientedSurface&&) noexcept;
  OrientedSurface& operator=(OrientedSurface&&) noexcept;

  /// The foot of each point, the same on any number of threads. Throws std::invalid_argument if the surface
  /// has no triangles. Cost: about log n per point, parallel.
  std::vector<SignedFoot> feet(const std::vector<glm::dvec3>& points_mm) const;

  /// The distance of a foot, without its position.
  struct Distance {
    double mm = 0.0;  ///< negative inside
    bool on_border = false;
  };
  /// The distances of feet(), at a fifth of the memory.
  std::vector<Distance> distances(const std::vector<glm::dvec3>& points_mm) const;

 private:
  struct Surface;
  std::unique_ptr<const Surface> surface_;
};

}  // namespace octotomy::brep
