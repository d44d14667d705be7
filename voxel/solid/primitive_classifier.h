// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>

#include "voxel/solid/shape.h"

// Primitives as a walk over a universe meets them: what a cube of its index space holds of one. The decisions
// are those of regular sets: a cube is inside where no open part of it lies outside, and touches where an
// open part of it lies inside, so that a cube that a surface only brushes from without is outside, and that a
// primitive and its complement swap the two answers exactly.
//
// Each decides a cube by a closed form, in double precision; only a torus whose axis is oblique to the
// lattice is bounded.

namespace octotomy::voxel {

/// A cube of index space.
struct Cube {
  glm::dvec3 centre{0.0};
  double half = 0.5;

  Cube octant(int number) const {
    const glm::dvec3 way(number & 1 ? 1 : -1, number & 2 ? 1 : -1, number & 4 ? 1 : -1);
    return {centre + 0.5 * half * way, 0.5 * half};
  }
};

/// Whether open parts of a cube lie inside and outside. `in` and `out` may claim too much unless they are
/// sure.
struct Meets {
  bool in = true;
  bool out = true;
  bool sure_in = false;
  bool sure_out = false;

  static Meets exactly(bool in, bool out) { return {in, out, in, out}; }
  bool decided() const { return in == sure_in && out == sure_out; }
  Meets complement() const { return {out, in, sure_out, sure_in}; }
};

/// A plane tangent to a surface: inside where gradient . (p - centre of the cube) + value <= 0.
struct Tangent {
  glm::dvec3 gradient{0.0};
  double value = 0.0;
};

/// Surfaces of a primitive within a cube: one of them, and how many there are; more than one meet in an edge.
/// `off_voxels` bounds the distance between the surface and its tangent within the cube.
struct Sheets {
  int count = 0;
  Tangent first;
  double off_voxels = 0.0;
};

/// A sphere or an ellipsoid: a ball of `radius` under an affine map of index space.
class BallClassifier {
 public:
  BallClassifier(const glm::dmat4& local_from_voxel, double radius);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  Sheets sheets(const Cube& cube) const;

 private:
  glm::dmat3 map_;
  glm::dvec3 origin_;
  double radius_;
  bool orthogonal_;  ///< the columns of the map are at right angles
};

/// Voxels where gradient . p + constant <= 0.
class HalfSpaceClassifier {
 public:
  HalfSpaceClassifier(const glm::dvec3& gradient, double constant)
      : gradient_(gradient), constant_(constant) {}
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const { return glm::dot(gradient_, p_voxel) + constant_ <= 0.0; }
  Sheets sheets(const Cube& cube) const;

 private:
  glm::dvec3 gradient_;
  double constant_;
};

class BoxClassifier {
 public:
  BoxClassifier(const glm::dmat4& local_from_voxel, const glm::dvec3& half_mm);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  Sheets sheets(const Cube& cube) const;

 private:
  glm::dmat3 map_;
  glm::dvec3 origin_;
  glm::dvec3 half_mm_;
};

/// A frame of two coordinates across and one along, cut to a range along.
struct Swept {
  glm::dmat3 map;  ///< rows: two across, one along, in millimetres
  glm::dvec3 origin;
  double low_mm, high_mm;

  glm::dvec3 local(const glm::dvec3& p_voxel) const { return map * p_voxel + origin; }
};

class CylinderClassifier {
 public:
  CylinderClassifier(const Swept& swept, double radius_mm) : swept_(swept), radius_mm_(radius_mm) {}
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  Sheets sheets(const Cube& cube) const;

 private:
  Swept swept_;
  double radius_mm_;
};

class PrismClassifier {
 public:
  PrismClassifier(const Swept& swept, const Region& region) : swept_(swept), region_(region) {}
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const;
  Sheets sheets(const Cube& cube) const;

 private:
  Swept swept_;
  Region region_;
};

class TorusClassifier {
 public:
  TorusClassifier(const Swept& swept, double ring_radius_mm, double tube_radius_mm);
  Meets meets(const Cube& cube) const;
  bool contains(const glm::dvec3& p_voxel) const { return value(swept_.local(p_voxel)) <= 0.0; }
  Sheets sheets(const Cube& cube) const;

 private:
  double value(const glm::dvec3& local_mm) const;

  Swept swept_;
  double ring_radius_mm_, tube_radius_mm_;
  bool upright_;  ///< each lattice axis runs along the torus's axis or across it
};

}  // namespace octotomy::voxel
