// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "brep/mesh/mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {

/// Whether a point is inside a closed surface, as SurfaceTree::inside() says, but without a tree: linear in
/// the triangles, parallel, and so the better way for a few points.
bool is_inside(const glm::dvec3& p_mm, const Triangles& surface);

/// A triangle that a ray towards +x passes.
struct Crossing {
  std::uint32_t face = 0;
  bool leaving = false;  ///< from the inside out, as the triangle winds
};

/// The nearest point of a surface to a point.
struct Foot {
  glm::dvec3 p_mm{0.0};
  double distance_mm = 0.0;  ///< unsigned
  std::uint32_t face = 0;    ///< one of the nearest, where several are equally near
  glm::dvec3 weights{
      0.0};  ///< of the face's corners: the foot's barycentric coordinates, exact zeros on sides
};

/// The point of a triangle that is nearest to a point.
glm::dvec3 nearest_of_triangle(const glm::dvec3& p_mm, const glm::dvec3& a_mm, const glm::dvec3& b_mm,
                               const glm::dvec3& c_mm);

/// The squared distance of a point to a segment, in square millimetres. One whose squared length is 0 counts
/// as its first end.
double squared_distance_to_segment(const glm::dvec3& p_mm, const glm::dvec3& a_mm, const glm::dvec3& b_mm);

/// A tree of boxes over a surface's triangles, copied, that answers questions about points in LPS
/// millimetres. Answers do not depend on the number of threads. Building: n log n, about 150 bytes a
/// triangle.
class SurfaceTree {
 public:
  explicit SurfaceTree(const Mesh& mesh) : SurfaceTree(triangles_of(mesh)) {}
  explicit SurfaceTree(const Triangles& triangles);
  /// Hasty: built in linear time along a curve, for a surface that is asked about a few times. Distances are
  /// the same but for rounding; of faces that are equally near, feet() may name another.
  /// ForSegments: as Searched, for meets_any(); about 45 bytes a triangle more.
  enum class Build { Searched, Hasty, ForSegments };
  SurfaceTree(const Triangles& triangles, Build build);
  ~SurfaceTree();
  SurfaceTree(SurfaceTree&&) noexcept;
  SurfaceTree& operator=(SurfaceTree&&) noexcept;

  /// The unsigned distance of each point to the nearest point of the surface. Throws std::invalid_argument
  /// where the surface has no triangles. Cost: about log n a point, parallel.
  std::vector<double> distances_mm(const std::vector<glm::dvec3>& points_mm) const;

  /// The same of one point. The search starts with `triangle`, a place in the tree (0 will do), and leaves
  /// there the nearest one: neighbours in space find theirs at once. Any number below `enough_mm` stands for
  /// all of them: the search ends with the first that it finds.
  double distance_mm(const glm::dvec3& p_mm, std::uint32_t& triangle, double enough_mm = 0.0) const;

  /// The foot of one point, by the same search. Below `enough_mm` it is that of any triangle so near.
  Foot foot(const glm::dvec3& p_mm, std::uint32_t& triangle, double enough_mm = 0.0) const;

  /// The foot of each point, by the same search. Throws as distances_mm() and costs as much.
  std::vector<Foot> feet(const std::vector<glm::dvec3>& points_mm) const;
  /// The same, each told by the point's number, from several threads.
  void visit_feet(const std::vector<glm::dvec3>& points_mm,
                  const std::function<void(std::size_t point, const Foot& foot)>& visit) const;

  /// 1 for each point inside, 0 outside, by parity along +x: a ray through an edge or vertex counts once, by
  /// the half-open rule, and exactly, however near the surface the point is; on it, it may be either.
  /// Precondition: closed. Parallel.
  std::vector<std::uint8_t> inside(const std::vector<glm::dvec3>& points_mm) const;

  /// The same of one point.
  bool is_inside(const glm::dvec3& p_mm) const;

  /// Whether `meets(face)` says true of any of the triangles that a segment may meet: it is asked about all
  /// that meet it and some near it, until it says so. Precondition: built ForSegments. Cost: about
  /// log n and the triangles that it passes.
  bool meets_any(const glm::dvec3& from_mm, const glm::dvec3& to_mm,
                 const std::function<bool(std::uint32_t face)>& meets) const;

  /// The triangles that a ray from a point towards +x passes, by face number, by the same rule.
  std::vector<Crossing> crossings(const glm::dvec3& p_mm) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace octotomy::brep
