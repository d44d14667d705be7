// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <variant>
#include <vector>

#include "voxel/solid/primitive_classifier.h"
#include "voxel/solid/shape.h"

namespace octotomy::voxel {

/// A shape in a universe's index space: its primitives (primitive_classifier.h) at once. Cubes that they
/// leave open, as intersections of surfaces and an oblique torus do, are bounded and refined (resolve()).
class ShapeClassifier {
 public:
  ShapeClassifier(const Shape& shape, const glm::dmat4& lps_from_voxel);

  /// Bounds at the cost of one look.
  Meets meets(const Cube& cube) const;
  /// The same, undecided cubes halved until they are decided or 2^-6 of the cube wide; what is left then
  /// counts as met, in and out: a shape's thin end up to that far from a voxel may make it a boundary voxel.
  Meets resolve(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  /// The share of the cube that lies inside. The cube is halved until at most one surface cuts each piece, no
  /// more than 2^-9 of a voxel from its tangent plane, whose cut is a closed form; pieces of 2^-4 of the cube
  /// that an edge still runs through take the product of their surfaces' shares. Error: within 2^-9 on
  /// a surface of curvature up to 1/3 a voxel, within 2^-4 of the length of edges through the cube.
  double fraction(const Cube& cube) const;

 private:
  using Primitive = std::variant<BallClassifier, HalfSpaceClassifier, BoxClassifier, CylinderClassifier,
                                 PrismClassifier, TorusClassifier>;
  struct Part {
    Primitive primitive;
    bool complement = false;
  };
  Meets meets_all(const Cube& cube) const;
  Meets refined(const Cube& cube, int halvings) const;
  double share(const Cube& cube, int halvings) const;

  std::vector<Part> parts_;
  bool complement_ = false;
};

/// The share of the cube [-half, half]^3 on the inner side of a plane. Source: Scardovelli and Zaleski,
/// J. Computational Physics 164, 2000, eq. 2-4.
double share_below(const Tangent& tangent, double half);

}  // namespace octotomy::voxel
