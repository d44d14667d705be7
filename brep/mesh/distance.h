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

/// Whether a point is inside a closed surface, with the result of SurfaceTree::inside() but without a tree.
/// Linear in the triangles and parallel, so faster for a few points.
bool is_inside(const glm::dvec3& p_mm, const Triangles& surface);

/// A triangle that a ray towards +x crosses.
struct Crossing {
  std::uint32_t face = 0;
  bool leaving = false;  ///< the ray leaves the solid there, by the triangle's winding
};

/// The nearest point of a surface to a point.
struct Foot {
  glm::dvec3 p_mm{0.0};
  double distance_mm = 0.0;  ///< unsigned
  std::uint32_t face = 0;    ///< the nearest face, or one of several equally near ones
  glm::dvec3 weights{
      0.0};  ///< barycentric coordinates of the foot by the face's corners; exactly zero on sides
};

/// The point of a triangle that is nearest to a point.
glm::dvec3 nearest_of_triangle(const glm::dvec3& p_mm, const glm::dvec3& a_mm, const glm::dvec3& b_mm,
                               const glm::dvec3& c_mm);

/// The squared distance of a point to a segment, in square millimetres. If the segment's squared length is 0,
/// the distance is that to its first end.
double squared_distance_to_segment(const glm::dvec3& p_mm, const glm::dvec3& a_mm, const glm::dvec3& b_mm);

/// A tree of boxes over a copy of a surface's triangles, for queries about points in LPS millimetres. Results
/// do not depend on the number of threads. Building: n log n, about 150 bytes per triangle.
class SurfaceTree {
 public:
  explicit SurfaceTree(const Mesh& mesh) : SurfaceTree(triangles_of(mesh)) {}
  explicit SurfaceTree(const Triangles& triangles);
  /// Searched: built by halving, n log n. Hasty: built in linear time along a curve, for few queries. Its
  /// distances are the same up to rounding; among equally near faces, feet() may return a different one.
  /// ForSegments: as Searched, but also for meets_any(); about 45 bytes per triangle more.
  enum class Build { Searched, Hasty, ForSegments };
  SurfaceTree(const Triangles& triangles, Build build);
  ~SurfaceTree();
  SurfaceTree(SurfaceTree&&) noexcept;
  SurfaceTree& operator=(SurfaceTree&&) noexcept;

  /// The unsigned distance of each point to the nearest point of the surface. Throws std::invalid_argument if
  /// the surface has no triangles. Cost: about log n per point, parallel.
  std::vector<double> distances_mm(const std::vector<glm::dvec3>& points_mm) const;

  /// The distance of one point. The search starts with `triangle`, a number in the tree (such as 0), and
  /// stores the nearest triangle there, which makes the next search fast if its point is near. The search
  /// ends at the first distance below `enough_mm`, even if it is not the least.
  double distance_mm(const glm::dvec3& p_mm, std::uint32_t& triangle, double enough_mm = 0.0) const;

  /// The foot of one point, by the same search. If a triangle is nearer than `enough_mm`, the foot may be
  /// that on any such triangle.
  Foot foot(const glm::dvec3& p_mm, std::uint32_t& triangle, double enough_mm = 0.0) const;

  /// The foot of each point, by the same search. Throws as distances_mm() and costs as much.
  std::vector<Foot> feet(const std::vector<glm::dvec3>& points_mm) const;
  /// As feet(), but calls `visit` with each point's number and foot, from several threads.
  void visit_feet(const std::vector<glm::dvec3>& points_mm,
                  const std::function<void(std::size_t point, const Foot& foot)>& visit) const;

  /// The distance of each point, negative where inside() is true. Where the foot of a point lies clearly
  /// within a triangle, the point's side of that triangle decides, and no ray is needed. A search starts
  /// with its point's triangle in `nearest`, a number in the tree, and stores the nearest triangle there.
  /// If `nearest` has `unknown_triangle`, it starts with the triangle of the point before. Preconditions:
  /// closed and oriented; `nearest` is as long as the points. Throws as distances_mm().
  std::vector<double> signed_distances_mm(const std::vector<glm::dvec3>& points_mm,
                                          std::vector<std::uint32_t>& nearest) const;
  static constexpr std::uint32_t unknown_triangle = 0xFFFFFFFFU;

  /// 1 for each point inside, 0 outside, by the parity of crossings along +x. A ray through an edge or vertex
  /// crosses once, by the half-open rule. Exact, however near the surface a point is; a point on the surface
  /// may be either. Precondition: closed. Parallel.
  std::vector<std::uint8_t> inside(const std::vector<glm::dvec3>& points_mm) const;

  /// Whether one point is inside.
  bool is_inside(const glm::dvec3& p_mm) const;

  /// Whether `meets(face)` is true for any triangle that a segment may meet. Calls `meets` for the triangles
  /// that the segment meets, and some near it, until a call returns true. Precondition: built ForSegments.
  /// Cost: about log n, and the triangles along the segment.
  bool meets_any(const glm::dvec3& from_mm, const glm::dvec3& to_mm,
                 const std::function<bool(std::uint32_t face)>& meets) const;

  /// The triangles that a ray from a point towards +x crosses, in order of face number, by the rule of
  /// inside().
  std::vector<Crossing> crossings(const glm::dvec3& p_mm) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace octotomy::brep
