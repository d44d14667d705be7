// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// A ball in LPS millimetres.
struct Ball {
  glm::dvec3 centre_mm{0.0};
  double radius_mm = 0.0;
};

/// Balls that touch a surface from inside. Holds a tree of boxes over the triangles. Building: n log n, about
/// 150 bytes a triangle. Any number of threads may call it.
class InscribedBalls {
 public:
  /// Precondition: the surface has triangles, and its points are finite.
  explicit InscribedBalls(const Triangles& surface);

  /// The distance from a point of the surface straight inward, along its unit normal, to the next point of
  /// the surface; infinity if there is none. Places within 2^-30 of the surface's extent count as the point
  /// itself. Cost: about log n.
  double ray_mm(const glm::dvec3& p_mm, const glm::dvec3& normal) const;

  /// The largest ball that touches the surface at a point, has its centre opposite to the unit normal
  /// there, and holds no other sheet; its diameter is at most `ray_mm`, which is ray_mm() of the point. A
  /// triangle whose nearest point to the centre lies within the angle of `least_cosine` of the point, seen
  /// from the centre, belongs to the point's own sheet. The radius is exact up to rounding. Where very many
  /// triangles touch the ball, as on a sphere, it is too large by at most 0.5 %. Cost: about log n, and at
  /// most some thousand further nodes of the tree.
  Ball touching(const glm::dvec3& p_mm, const glm::dvec3& normal, double ray_mm, double least_cosine) const;

  /// Whether the surface touches a ball not only at `p_mm` but also, within 2.5 % of the radius, nearly
  /// opposite: seen from the ball's centre, both places are at least `least_rad` apart. Precondition:
  /// `least_rad` is above 90 degrees. Cost: about log n and the triangles near the opposite point.
  bool touches_opposite(const Ball& ball, const glm::dvec3& p_mm, double least_rad) const;

 private:
  /// A node over triangles begin .. end - 1, within a box and a slab across their mean normal. For a curved
  /// sheet the slab is much thinner than the box. An inner node's children are the next node and `second`,
  /// which is 0 in a leaf.
  struct Node {
    glm::dvec3 low_mm{0.0}, high_mm{0.0}, across{0.0};
    double slab_low_mm = 0.0, slab_high_mm = 0.0;
    std::uint32_t begin = 0, end = 0, second = 0;
    double squared_distance(const glm::dvec3& p_mm) const;
  };
  void add_slab(Node& node) const;
  struct Corners {
    glm::dvec3 a_mm, b_mm, c_mm;
  };

  double step_mm_ = 0.0;            ///< places nearer to each other count as one
  std::vector<Corners> triangles_;  ///< in the leaves' order
  std::vector<Node> nodes_;         ///< a parent before its children
};

/// Finds the largest of many balls that contain a point.
class LargestBall {
 public:
  explicit LargestBall(std::vector<Ball> balls);

  /// The largest ball that contains the point, or `known` if `known` is larger. The radius may be too small
  /// by up to 0.1 %, so that not all balls of nearly one size are compared. Cost: about log n where radii
  /// vary slowly from place to place.
  Ball about(const glm::dvec3& p_mm, const Ball& known) const;

 private:
  struct Node {
    glm::dvec3 low_mm{0.0}, high_mm{0.0};  ///< of centres
    double largest_mm = 0.0;
    std::uint32_t begin = 0, end = 0, second = 0;
  };

  std::vector<Ball> balls_;  ///< in the leaves' order
  std::vector<Node> nodes_;
};

}  // namespace octotomy::brep
