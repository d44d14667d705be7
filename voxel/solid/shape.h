// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <variant>
#include <vector>

#include "voxel/solid/expression.h"
#include "voxel/solid/region_mask.h"
#include "voxel/space/lattice.h"

namespace octotomy::voxel {

// Solids with closed forms, in LPS millimetres. A turn `lps_from_axes` is a rotation that carries the solid's
// own axes to LPS.

struct Ellipsoid {
  glm::dvec3 centre_mm{0.0};
  glm::dvec3 radii_mm{1.0};
  glm::dmat3 lps_from_axes{1.0};
};
struct OrientedBox {
  glm::dvec3 centre_mm{0.0};
  glm::dvec3 half_mm{1.0};  ///< half of its edges
  glm::dmat3 lps_from_axes{1.0};
};
/// Between two discs.
struct Cylinder {
  glm::dvec3 from_mm{0.0};
  glm::dvec3 to_mm{0, 0, 1};
  double radius_mm = 1.0;
};
/// A ring: the points within tube_radius_mm of a circle.
struct Torus {
  glm::dvec3 centre_mm{0.0};
  glm::dvec3 axis{0, 0, 1};  ///< unit
  double ring_radius_mm = 2.0;
  double tube_radius_mm = 1.0;
};
/// A region, holes and all, swept along its view's look from one depth (p . look) to another. Edges of its
/// polygons may touch but not cross, nor lie upon each other.
struct Prism {
  Region region;
  double low_mm = 0.0;
  double high_mm = 1.0;
};

using Primitive = std::variant<Sphere, Ellipsoid, Box, OrientedBox, HalfSpace, Cylinder, Torus, Prism>;

/// An intersection of primitives and complements of primitives, or the complement of one. A value.
class Shape {
 public:
  struct Part {
    Primitive primitive;
    bool complement = false;
  };

  /// Throws std::invalid_argument saying what is wrong: a number that is not finite, a length that is not
  /// positive, an axis or a turn that is none, a torus whose tube is as wide as its ring.
  template <typename Solid>
  requires std::is_constructible_v<Primitive, Solid> Shape(const Solid& solid) : Shape(Primitive(solid)) {}
  Shape(const Primitive& primitive);

  friend Shape operator~(Shape shape);
  /// Throws std::invalid_argument where one of them is the complement of an intersection: a union is no
  /// Shape.
  friend Shape operator&(const Shape& a, const Shape& b);

  const std::vector<Part>& parts() const { return parts_; }
  /// True: the points that are not in the intersection of the parts.
  bool complement() const { return complement_; }

 private:
  std::vector<Part> parts_;
  bool complement_ = false;
};
Shape operator~(Shape shape);
Shape operator&(const Shape& a, const Shape& b);
inline Shape operator-(const Shape& a, const Shape& b) {
  return a & ~b;
}

}  // namespace octotomy::voxel
