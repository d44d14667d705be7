// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/exact_boolean.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <array>
#include <cassert>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "brep/boolean/coincident_shells.h"
#include "brep/boolean/line_agreement.h"
#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/equal_points.h"
#include "brep/mesh/error.h"
#include "brep/mesh/short_text.h"
#include "brep/mesh/surface_mesh.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using ExactTriangles = PointTriangles<Kernel::Point_3>;
using Rational = Kernel::Exact_kernel::FT;

Surface surface_of(const Solid& solid, const std::string& name) {
  if (volume_mm3(solid) < 0.0)
    throw InvalidInput("operand " + name + "'s triangles face inward; reverse them first");
  return surface_mesh_of<Kernel::Point_3>(solid.triangles());
}

/// Refuses an operand that touches itself within the other's box: corefinement would treat coincident points
/// as one and break the mesh's links.
void need_points_apart(const Solid& solid, const Solid& other, const std::string& name) {
  const glm::dvec3 &low = other.size().low_mm, &high = other.size().high_mm;
  const std::vector<glm::dvec3>& points = solid.triangles().points_mm;
  const std::vector<std::uint32_t> first = first_equal_points(points);
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    const glm::dvec3& p = points[v];
    if (first[v] == v || glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) continue;
    throw Error(ErrorCode::Geometry, "no exact Boolean: operand " + name + " touches itself at (" +
                                         short_text(p.x) + ", " + short_text(p.y) + ", " + short_text(p.z) +
                                         ") mm: use the inexact Boolean, which resolves such points");
  }
}

/// Sums both halves recursively, so that most additions are of numbers with similarly many digits.
Rational sum_of(const std::vector<Rational>& terms, std::size_t begin, std::size_t end) {
  assert(begin <= end && end <= terms.size());
  if (end - begin == 0) return Rational(0);
  if (end - begin == 1) return terms[begin];
  const std::size_t middle = begin + (end - begin) / 2;
  return sum_of(terms, begin, middle) + sum_of(terms, middle, end);
}

ExactTriangles triangles_of(const Surface& surface) {
  ExactTriangles triangles;
  std::vector<std::uint32_t> number(surface.num_vertices() + surface.number_of_removed_vertices());
  for (const auto v : surface.vertices()) {
    number[v] = static_cast<std::uint32_t>(triangles.points.size());
    triangles.points.push_back(surface.point(v));
  }
  for (const auto f : surface.faces()) {
    std::array<std::uint32_t, 3> face{};
    auto corner = face.begin();
    for (const auto v : surface.vertices_around_face(surface.halfedge(f))) {
      assert(corner != face.end());
      *corner++ = number[v];
    }
    triangles.faces.push_back(face);
  }
  return triangles;
}

/// Six times the volume.
Rational six_volumes(const ExactTriangles& triangles) {
  std::vector<Rational> terms;
  for (const auto& face : triangles.faces) {
    std::array<std::array<Rational, 3>, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const Kernel::Point_3& point = triangles.points[face[k]];
      p[k] = {CGAL::exact(point.x()), CGAL::exact(point.y()), CGAL::exact(point.z())};
    }
    terms.push_back(p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
                    p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
                    p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]));
  }
  return sum_of(terms, 0, terms.size());
}

double mm3_of(const Rational& six) {
  return CGAL::to_double(six) / 6.0;
}

void prove(const Rational& whole, const Rational& parts, const std::string& identity) {
  if (whole == parts) return;
  throw Error(ErrorCode::Geometry, "exact volumes do not add up: " + identity + " misses by " +
                                       std::to_string(mm3_of(whole - parts)) +
                                       " mm3; an operand intersects itself: check its health");
}

Triangles rounded(const ExactTriangles& exact, std::size_t& moved) {
  Triangles triangles{{}, exact.faces};
  for (const Kernel::Point_3& p : exact.points) {
    const glm::dvec3 near(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
    moved += p != Kernel::Point_3(near.x, near.y, near.z);
    triangles.points_mm.push_back(near);
  }
  // CGAL iterates in the order of addresses, which differs from run to run.
  return in_coordinate_order(mesh_of(triangles));
}

/// Converts CGAL's callbacks to progress: intersecting edges and faces is half of the work, cutting faces the
/// other half.
struct Watched : pmp::Corefinement::Default_visitor<Surface> {
  const Progress* progress = nullptr;
  std::size_t steps = 0, step = 0;
  double from = 0.0;

  void begin(std::size_t count, double share) {
    steps = std::max(count, std::size_t{1});
    step = 0;
    from = share;
  }
  void advance() {
    if (progress->stop.stop_requested()) throw Stopped("the exact Boolean was stopped");
    progress->at(from + 0.45 * static_cast<double>(++step) / static_cast<double>(steps));
  }
  void start_handling_edge_face_intersections(std::size_t count) { begin(count, 0.0); }
  void edge_face_intersections_step() { advance(); }
  void start_triangulating_faces(std::size_t count) { begin(count, 0.45); }
  void triangulating_faces_step() { advance(); }
};

/// The surfaces cut by each other, and the wanted results.
struct Cut {
  ExactTriangles a, b;
  std::array<std::optional<ExactTriangles>, 4> results;  ///< the wanted results that are manifold
};

Cut cut(const Solid& a, const Solid& b, const std::vector<ResultPlace>& asked, const Progress& progress) {
  Surface exact_a = surface_of(a, "a"), exact_b = surface_of(b, "b");
  std::array<Surface, 4> surfaces;
  std::array<boost::optional<Surface*>, 4> output;
  static_assert(int{pmp::Corefinement::UNION} == int{of_union} &&
                int{pmp::Corefinement::INTERSECTION} == int{of_intersection} &&
                int{pmp::Corefinement::TM1_MINUS_TM2} == int{of_a_minus_b} &&
                int{pmp::Corefinement::TM2_MINUS_TM1} == int{of_b_minus_a});
  for (const ResultPlace r : asked) output[r] = &surfaces[r];
  Watched watched;
  watched.progress = &progress;
  const std::array<bool, 4> manifold = pmp::corefine_and_compute_boolean_operations(
      exact_a, exact_b, output, CGAL::parameters::visitor(watched));
  Cut made{triangles_of(exact_a), triangles_of(exact_b), {}};
  for (const ResultPlace r : asked)
    if (manifold[r]) made.results[r] = triangles_of(surfaces[r]);
  return made;
}

}  // namespace

ExactBoolean exact_boolean(const Solid& a, Operation operation, const Solid& b, const Progress& progress) {
  need_points_apart(a, b, "a");
  need_points_apart(b, a, "b");
  const Rational of_a = six_volumes(triangles_of(surface_of(a, "a"))),
                 of_b = six_volumes(triangles_of(surface_of(b, "b")));
  const ResultPlace wanted = operation == Operation::Union          ? of_union
                             : operation == Operation::Intersection ? of_intersection
                                                                    : of_a_minus_b;
  std::vector<ResultPlace> asked = {of_union, of_intersection};
  if (wanted == of_a_minus_b) asked.push_back(wanted);
  Cut made = cut(a, b, asked, progress);
  // The union of solids that touch along an edge is not manifold. The differences then prove the result.
  if (!made.results[of_union] && wanted != of_union)
    made = cut(a, b, {of_intersection, of_a_minus_b, of_b_minus_a}, progress);
  auto& results = made.results;
  const bool by_differences = !results[of_union];
  if (!results[wanted] || !results[of_intersection] ||
      (by_differences && (wanted == of_union || !results[of_a_minus_b] || !results[of_b_minus_a])))
    throw Error(ErrorCode::Geometry,
                "no exact Boolean: a result would not be manifold, because the surfaces only touch: use the "
                "inexact Boolean, which moves one of them by a negligible length");

  progress.at(0.9);
  correct_contrary_shells(made.a, made.b, results, Kernel().less_xyz_3_object());
  const Rational common = six_volumes(*results[of_intersection]);
  const Rational united = by_differences ? of_a + of_b - common : six_volumes(*results[of_union]);
  if (!by_differences) prove(of_a + of_b, united + common, "|A| + |B| = |A u B| + |A n B|");
  const Rational result = operation == Operation::Union          ? united
                          : operation == Operation::Intersection ? common
                                                                 : six_volumes(*results[wanted]);
  if (by_differences || operation == Operation::Difference)
    prove(of_a, six_volumes(*results[of_a_minus_b]) + common, "|A| = |A - B| + |A n B|");
  if (by_differences) prove(of_b, six_volumes(*results[of_b_minus_a]) + common, "|B| = |B - A| + |A n B|");

  std::size_t moved = 0;
  const Solid solid = trusted_solid(rounded(*results[wanted], moved), Proof::Rounded);
  Results answer;
  Wanted checked{};
  answer[wanted] = solid.triangles();
  checked[wanted] = true;
  if (const auto wrong = disagreement_along_lines(a, b, answer, checked))
    throw Error(ErrorCode::Geometry, "no exact Boolean: the result" + text_of(*wrong) +
                                         "; check the health of both operands and repair them");
  const double rounding = solid.empty() ? 0.0 : volume_mm3(solid) - mm3_of(result);
  return {solid, mm3_of(of_a), mm3_of(of_b), mm3_of(united), mm3_of(common), mm3_of(result), rounding, moved};
}

}  // namespace octotomy::brep
