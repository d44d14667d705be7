// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 refuse open and inside-out operands; 2 corefine copies, all results from one pass; 3 let the volumes
// vouch for each other; 4 where a wanted result is not manifold or the volumes do not add up, try again with
// b moved by far less than any bound, and tell. The only unit that sees corefinement, which is dear to
// compile.
#include "brep/boolean.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "brep/measure.h"
#include "brep/triangles.h"

namespace octotomy::brep {

/// Steps along halfedges that the corefinement under way may still take.
struct StepBudget {
  static thread_local std::size_t left;
};
thread_local std::size_t StepBudget::left = 0;

// CGAL finds these for our mesh instead of its own. Where surfaces all but coincide it may link halfedges
// into rings that its walks never leave.
inline void take_step() {
  if (StepBudget::left == 0) throw std::runtime_error("its walk along the surface does not end");
  --StepBudget::left;
}
inline OpenMesh::HalfedgeHandle next(OpenMesh::HalfedgeHandle h, const Mesh& mesh) {
  take_step();
  return mesh.next_halfedge_handle(h);
}
inline OpenMesh::HalfedgeHandle prev(OpenMesh::HalfedgeHandle h, const Mesh& mesh) {
  take_step();
  return mesh.prev_halfedge_handle(h);
}

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// The mesh's points as CGAL's. CGAL's own map of OpenMesh points writes them through float.
struct PointMap {
  using category = boost::read_write_property_map_tag;
  using key_type = boost::graph_traits<Mesh>::vertex_descriptor;
  using value_type = Kernel::Point_3;
  using reference = Kernel::Point_3;
  Mesh* mesh = nullptr;

  friend reference get(const PointMap& map, key_type v) {
    const Mesh::Point& p = map.mesh->point(v);
    return {p[0], p[1], p[2]};
  }
  friend void put(const PointMap& map, key_type v, const value_type& p) {
    map.mesh->set_point(v, Mesh::Point(p.x(), p.y(), p.z()));
  }
};

void check_operand(const Mesh& mesh, const Measures& measures, const std::string& name) {
  for (const auto e : mesh.edges())
    if (mesh.is_boundary(e))
      throw std::invalid_argument("operand " + name + " is open: edge " + std::to_string(e.idx()) +
                                  " has one triangle; a Boolean takes solids, close the surface first");
  if (!std::isfinite(measures.volume_mm3) || measures.volume_mm3 < 0.0)
    throw std::invalid_argument("operand " + name + " has volume " + std::to_string(measures.volume_mm3) +
                                " mm3: its triangles face inward; turn them round first");
}

double extent_mm(const Measures& a, const Measures& b) {
  return glm::length(glm::max(a.high_mm, b.high_mm) - glm::min(a.low_mm, b.low_mm));
}

/// Largest coordinate: what the last place of the points is relative to.
double reach_mm(const Measures& a, const Measures& b) {
  double reach = 0.0;
  for (const glm::dvec3& p : {a.low_mm, a.high_mm, b.low_mm, b.high_mm})
    reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return reach;
}

/// What the volumes may be off by where all is well. A new point is rounded by half a unit of the last place
/// in each coordinate, which moves the surface by no more, and errors of either sign cancel: on skulls of
/// 600k triangles the volumes add up to within a hundredth of one unit over the whole area. Slivers that
/// cross at a small angle may be worse; 2^12 units leave room for them and are still far below what a lost
/// triangle costs.
double volume_tolerance_mm3(const Measures& a, const Measures& b) {
  return 0x1p12 * std::numeric_limits<double>::epsilon() * reach_mm(a, b) * (a.area_mm2 + b.area_mm2);
}

/// The remedy's shift: 2^-18 of the extent for the first try, about 1 um for a head of 250 mm; further tries
/// go the other way and further. It lies 2^34 units of the last place above rounding, so that nothing stays
/// in touch, and far below a voxel. The direction has no plane or edge in common with anything likely.
glm::dvec3 shift_mm(int attempt, double extent) {
  if (attempt == 0) return glm::dvec3(0.0);
  const glm::dvec3 direction = glm::normalize(glm::dvec3(1.0, std::cbrt(2.0), std::cbrt(4.0)));
  const double steps = attempt % 2 == 1 ? attempt : -attempt;
  return direction * (steps * 0x1p-18 * extent);
}
constexpr int attempt_count = 4;

struct Attempt {
  Booleans results;
  std::string failure;  ///< empty where all that was wanted is there and adds up
};

/// What is wanted and what the volumes need to vouch for it: the intersection always, and where nothing else
/// is wanted the difference that is the smaller mesh.
BooleansWanted with_witnesses(BooleansWanted wanted, const Mesh& a, const Mesh& b) {
  wanted.intersection = true;
  if (!wanted.united && !wanted.a_minus_b && !wanted.b_minus_a)
    (a.n_faces() < b.n_faces() ? wanted.a_minus_b : wanted.b_minus_a) = true;
  return wanted;
}

/// The same surface with points and triangles in the order of their coordinates. Corefinement leaves them in
/// an order that hangs on addresses, so that the same operands gave other bits in about one run of ten: sums
/// over faces in their last places, and all that decimates or fills the surface later on. Points at one place
/// (rounded together) go by the places of their neighbours.
Mesh in_order(const Mesh& mesh) {
  Triangles triangles = triangles_of(mesh);
  const auto place = [&](std::uint32_t v) {
    const glm::dvec3& p = triangles.points_mm[v];
    return std::array<double, 3>{p.x, p.y, p.z};
  };
  const auto ring = [&](std::uint32_t v) {
    std::vector<std::array<double, 3>> places;
    for (const auto neighbour : mesh.vv_range(Mesh::VertexHandle(static_cast<int>(v))))
      places.push_back(place(static_cast<std::uint32_t>(neighbour.idx())));
    std::sort(places.begin(), places.end());
    return places;
  };
  std::vector<std::uint32_t> order(triangles.points_mm.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t v, std::uint32_t w) {
    const auto at_v = place(v), at_w = place(w);
    return at_v != at_w ? at_v < at_w : v != w && ring(v) < ring(w);
  });

  Triangles sorted;
  std::vector<std::uint32_t> rank(order.size());
  for (const std::uint32_t v : order) {
    rank[v] = static_cast<std::uint32_t>(sorted.points_mm.size());
    sorted.points_mm.push_back(triangles.points_mm[v]);
  }
  sorted.faces = std::move(triangles.faces);
  for (auto& face : sorted.faces) {
    for (std::uint32_t& v : face) v = rank[v];
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  }
  std::sort(sorted.faces.begin(), sorted.faces.end());
  return mesh_of(sorted);
}

/// What a sound corefinement stays far below: it takes some 100 steps a triangle.
std::size_t step_limit(const Mesh& a, const Mesh& b) {
  return 10'000 * (a.n_faces() + b.n_faces() + 1000);
}

/// Corefines copies of the operands.
Booleans corefine(Mesh a, Mesh b, const BooleansWanted& wanted, bool refuse_self_intersection) {
  std::array<Mesh, 4> meshes;
  std::array<boost::optional<Mesh*>, 4> output;
  const auto want = [&](std::size_t i, bool is_wanted) {
    if (is_wanted) output[i] = &meshes[i];
  };
  want(pmp::Corefinement::UNION, wanted.united);
  want(pmp::Corefinement::INTERSECTION, wanted.intersection);
  want(pmp::Corefinement::TM1_MINUS_TM2, wanted.a_minus_b);
  want(pmp::Corefinement::TM2_MINUS_TM1, wanted.b_minus_a);
  const auto to = [&](std::size_t i) { return CGAL::parameters::vertex_point_map(PointMap{&meshes[i]}); };
  StepBudget::left = step_limit(a, b);
  const std::array<bool, 4> manifold = pmp::corefine_and_compute_boolean_operations(
      a, b, output,
      CGAL::parameters::vertex_point_map(PointMap{&a}).throw_on_self_intersection(refuse_self_intersection),
      CGAL::parameters::vertex_point_map(PointMap{&b}), std::make_tuple(to(0), to(1), to(2), to(3)));

  Booleans results;
  const auto take = [&](std::size_t i, std::optional<Mesh>& result) {
    if (!output[i] || !manifold[i]) return;
    meshes[i].garbage_collection();
    result = in_order(meshes[i]);
  };
  take(pmp::Corefinement::UNION, results.united);
  take(pmp::Corefinement::INTERSECTION, results.intersection);
  take(pmp::Corefinement::TM1_MINUS_TM2, results.a_minus_b);
  take(pmp::Corefinement::TM2_MINUS_TM1, results.b_minus_a);
  return results;
}

std::optional<double> volume_of(const std::optional<Mesh>& mesh) {
  if (!mesh) return std::nullopt;
  return volume_mm3(*mesh);
}

/// The largest disagreement of the volumes, in cubic millimetres.
std::optional<double> disagreement_mm3(const Booleans& results, double a_mm3, double b_mm3) {
  const auto united = volume_of(results.united), common = volume_of(results.intersection);
  const auto a_only = volume_of(results.a_minus_b), b_only = volume_of(results.b_minus_a);
  std::optional<double> worst;
  const auto compare = [&](double difference) {
    worst = std::max(worst.value_or(0.0), std::abs(difference));
  };
  if (united && common) compare((a_mm3 + b_mm3) - (*united + *common));
  if (a_only && common) compare(a_mm3 - (*a_only + *common));
  if (b_only && common) compare(b_mm3 - (*b_only + *common));
  return worst;
}

/// Points that more than one vertex has: where sheets of the surface touch, corefinement gives each its own.
std::size_t shared_point_count(const Mesh& mesh) {
  std::vector<Mesh::Point> points;
  points.reserve(mesh.n_vertices());
  for (const auto v : mesh.vertices()) points.push_back(mesh.point(v));
  std::sort(points.begin(), points.end(), [](const Mesh::Point& p, const Mesh::Point& q) {
    return std::tie(p[0], p[1], p[2]) < std::tie(q[0], q[1], q[2]);
  });
  std::size_t count = 0;
  for (std::size_t i = 1; i < points.size(); ++i)
    if (points[i] == points[i - 1] && (i == 1 || points[i] != points[i - 2])) ++count;
  return count;
}

void tell_touching(const BooleansWanted& wanted, Booleans& results) {
  const auto look_at = [&](bool is_wanted, const std::optional<Mesh>& mesh, const std::string& name) {
    const std::size_t count = is_wanted && mesh ? shared_point_count(*mesh) : 0;
    if (count > 0)
      results.findings.push_back(name + " touches itself at " + std::to_string(count) +
                                 (count == 1 ? " point" : " points"));
  };
  look_at(wanted.united, results.united, "the union");
  look_at(wanted.intersection, results.intersection, "the intersection");
  look_at(wanted.a_minus_b, results.a_minus_b, "a - b");
  look_at(wanted.b_minus_a, results.b_minus_a, "b - a");
}

std::string missing_of(const Booleans& results, const BooleansWanted& wanted) {
  std::string missing;
  const auto need = [&](bool is_wanted, const std::optional<Mesh>& mesh, const char* name) {
    if (is_wanted && !mesh) missing += (missing.empty() ? "" : ", ") + std::string(name);
  };
  need(wanted.united, results.united, "the union");
  need(wanted.intersection, results.intersection, "the intersection");
  need(wanted.a_minus_b, results.a_minus_b, "a - b");
  need(wanted.b_minus_a, results.b_minus_a, "b - a");
  return missing;
}

/// CGAL tells three troubles by exceptions: an operand that meets itself, constraints that cross within a
/// triangle (the same, seen later), and broken invariants.
Booleans corefine_telling(const Mesh& a, const Mesh& b, const BooleansWanted& wanted, std::string& failure) {
  for (const bool strict : {true, false}) {
    try {
      Booleans results = corefine(a, b, wanted, strict);
      if (!strict)
        results.findings.emplace_back(
            "an operand meets itself where the other cuts it; the volumes vouch for the result, its health "
            "may "
            "not");
      return results;
    } catch (const pmp::Corefinement::Self_intersection_exception&) {
      failure = "an operand meets itself where the other cuts it";
    } catch (const CGAL::Failure_exception& e) {
      failure = std::string("corefinement broke off: ") + e.what();
    } catch (const std::exception& e) {
      failure = std::string("corefinement broke off: ") + e.what();
    }
  }
  return {};
}

Attempt attempt_booleans(const Mesh& a, const Mesh& b, const BooleansWanted& wanted, const Measures& of_a,
                         const Measures& of_b) {
  Attempt attempt;
  attempt.results = corefine_telling(a, b, with_witnesses(wanted, a, b), attempt.failure);
  const std::string missing = missing_of(attempt.results, wanted);
  if (!missing.empty()) {
    if (attempt.failure.empty())
      attempt.failure = missing + " would not be manifold: the surfaces only touch";
    return attempt;
  }
  attempt.failure.clear();
  const auto disagreement = disagreement_mm3(attempt.results, of_a.volume_mm3, of_b.volume_mm3);
  if (!disagreement) {
    attempt.results.findings.emplace_back("too few results are manifold for their volumes to be compared");
    return attempt;
  }
  if (*disagreement > volume_tolerance_mm3(of_a, of_b))
    attempt.failure = "the results' volumes are " + std::to_string(*disagreement) + " mm3 from adding up, " +
                      std::to_string(volume_tolerance_mm3(of_a, of_b)) + " is allowed";
  const double whole = of_a.volume_mm3 + of_b.volume_mm3;
  attempt.results.residual = whole > 0.0 ? *disagreement / whole : 0.0;
  return attempt;
}

std::string text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.3g", value);
  return buffer.data();
}

}  // namespace

Booleans booleans(const Mesh& a, const Mesh& b, const BooleansWanted& wanted) {
  const Measures of_a = measure(a), of_b = measure(b);
  check_operand(a, of_a, "a");
  check_operand(b, of_b, "b");

  std::string first_failure;
  for (int i = 0; i < attempt_count; ++i) {
    const glm::dvec3 shift = shift_mm(i, extent_mm(of_a, of_b));
    Mesh placed = b;
    for (const auto v : placed.vertices())
      placed.set_point(v, placed.point(v) + Mesh::Point(shift.x, shift.y, shift.z));
    Attempt attempt = attempt_booleans(a, placed, wanted, of_a, of_b);
    if (attempt.failure.empty()) {
      if (i > 0)
        attempt.results.findings.push_back(
            "shifted: b was moved by (" + text(shift.x) + ", " + text(shift.y) + ", " + text(shift.z) +
            ") mm, which changes a volume by at most " + text(glm::length(shift) * of_b.area_mm2) +
            " mm3, as " + first_failure);
      tell_touching(wanted, attempt.results);
      return std::move(attempt.results);
    }
    if (i == 0) first_failure = attempt.failure;
  }
  throw std::runtime_error(
      "no Boolean: " + first_failure + ", and moving b by up to " +
      text(glm::length(shift_mm(attempt_count - 1, extent_mm(of_a, of_b)))) +
      " mm did not help; ask for the health of both operands and repair them, or move one");
}

BooleanResult boolean(const Mesh& a, Operation operation, const Mesh& b) {
  const BooleansWanted wanted{operation == Operation::Union, operation == Operation::Intersection,
                              operation == Operation::Difference, false};
  Booleans results = booleans(a, b, wanted);
  std::optional<Mesh>& mesh = operation == Operation::Union          ? results.united
                              : operation == Operation::Intersection ? results.intersection
                                                                     : results.a_minus_b;
  return {std::move(mesh.value()), results.residual, std::move(results.findings)};
}

}  // namespace octotomy::brep
