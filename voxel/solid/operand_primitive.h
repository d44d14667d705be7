// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "voxel/solid/cube.h"
#include "voxel/solid/primitive.h"

// Primitives as operands of a walk. Each tests a cube by a closed form in double precision. Only for a torus
// whose axis is oblique to the lattice, the answer is conservative. `still_from_target` maps the target's
// voxel indices to the primitive's LPS millimetres before its motion. Sources: operand_closed_form.cpp.

namespace octotomy::voxel {

/// An affine map of index space to a primitive's own frame.
struct LocalFrame {
  glm::dmat3 map{1.0};
  glm::dvec3 origin{0.0};

  glm::dvec3 operator()(const glm::dvec3& p_voxel) const { return map * p_voxel + origin; }
};

/// A sphere or an ellipsoid: a ball in its own frame.
class BallOperand {
 public:
  BallOperand(const Sphere& sphere, const glm::dmat4& still_from_target);
  BallOperand(const Ellipsoid& ellipsoid, const glm::dmat4& still_from_target);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const {
    const glm::dvec3 p = local_(p_voxel);
    return glm::dot(p, p) <= radius_ * radius_;
  }
  Sheets sheets(const Cube& cube) const;

 private:
  BallOperand(const LocalFrame& local, double radius);

  LocalFrame local_;
  double radius_;
  bool orthogonal_;               ///< whether a voxel's edges are at right angles in the ball's frame
  glm::dmat3 edges_from_local_;   ///< only if orthogonal: maps to the directions of the edges
  glm::dvec3 edge_lengths_{0.0};  ///< only if orthogonal: lengths of a voxel's edges in the ball's frame
};

class HalfSpaceOperand {
 public:
  HalfSpaceOperand(const HalfSpace& half_space, const glm::dmat4& still_from_target);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const { return glm::dot(gradient_, p_voxel) + constant_ <= 0.0; }
  Sheets sheets(const Cube& cube) const;

 private:
  glm::dvec3 gradient_;
  double constant_;
};

class BoxOperand {
 public:
  BoxOperand(const Box& box, const glm::dmat4& still_from_target);
  BoxOperand(const OrientedBox& box, const glm::dmat4& still_from_target);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const {
    return glm::all(glm::lessThanEqual(glm::abs(local_(p_voxel)), half_mm_));
  }
  Sheets sheets(const Cube& cube) const;

 private:
  BoxOperand(const LocalFrame& local, const glm::dvec3& half_mm);

  LocalFrame local_;
  glm::dvec3 half_mm_;
  glm::dvec3 reach_mm_;  ///< half extents, along the box's axes, of a cube with a half edge of 1
  bool straight_;        ///< whether each edge of a voxel is parallel to an axis of the box
};

/// The frame's third axis is the cylinder's; its origin is the cylinder's first end.
class CylinderOperand {
 public:
  CylinderOperand(const Cylinder& cylinder, const glm::dmat4& still_from_target);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const {
    const glm::dvec3 p = local_(p_voxel);
    return p.z >= 0.0 && p.z <= length_mm_ && p.x * p.x + p.y * p.y <= radius_mm_ * radius_mm_;
  }
  Sheets sheets(const Cube& cube) const;

 private:
  LocalFrame local_;
  double length_mm_, radius_mm_;
};

class TorusOperand {
 public:
  TorusOperand(const Torus& torus, const glm::dmat4& still_from_target);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const { return value(local_(p_voxel)) <= 0.0; }
  Sheets sheets(const Cube& cube) const;

 private:
  double value(const glm::dvec3& local_mm) const {
    return std::hypot(std::hypot(local_mm.x, local_mm.y) - ring_radius_mm_, local_mm.z) - tube_radius_mm_;
  }

  LocalFrame local_;
  double ring_radius_mm_, tube_radius_mm_;
  bool upright_;  ///< whether each edge of a voxel is parallel or perpendicular to the torus's axis
};

}  // namespace octotomy::voxel
