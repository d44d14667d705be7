// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/corefine.h"

// CGAL's checks of its invariants are enabled in every build. Without them, nearly degenerate operands can
// break CGAL's data and lead to invalid memory accesses. A failed check throws an exception, which is
// reported and handled like other failures.
#define CGAL_DEBUG
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <new>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "brep/boolean/coincident_shells.h"
#include "brep/mesh/coordinate_order.h"
#include "brep/mesh/flat_triangles.h"
#include "brep/mesh/triangles.h"

// One of those checks costs more than half of all time: after each point on a side of a triangle CGAL tests
// in exact numbers whether the whole triangulation of that triangle is Delaunay. It is disabled. Memory is
// protected by the check of the triangulation's links, and points in a wrong order show up in the results'
// volumes.
namespace CGAL {
using CutTraits = Projection_traits_3<Exact_predicates_exact_constructions_kernel>;
using CutLinks = Triangulation_data_structure_2<Triangulation_vertex_base_with_info_2<std::size_t, CutTraits>,
                                                Constrained_triangulation_face_base_2<CutTraits>>;
template <>
inline bool Constrained_Delaunay_triangulation_2<CutTraits, CutLinks>::is_valid(bool verbose,
                                                                                int level) const {
  return this->tds().is_valid(verbose, level);
}

namespace Box_intersection_d {
/// The boxes by which corefinement finds edges and faces that meet. CGAL orders equal boxes by address and
/// computes a point on several boxes from the first pair that it finds, so the last digits of points would
/// depend on the heap. These boxes are ordered by a number assigned at creation.
template <>
class Box_with_info_d<double, 3, OpenMesh::HalfedgeHandle, ID_FROM_BOX_ADDRESS>
    : public Box_with_info_d<double, 3, OpenMesh::HalfedgeHandle, ID_EXPLICIT> {
 public:
  using Box_with_info_d<double, 3, OpenMesh::HalfedgeHandle, ID_EXPLICIT>::Box_with_info_d;
};
}  // namespace Box_intersection_d
}  // namespace CGAL

namespace octotomy::brep {

/// The number of steps along halfedges that the current corefinement may still make, and a request to stop it
/// earlier.
struct StepBudget {
  static thread_local std::size_t left;
  static thread_local std::stop_token stop;
};
thread_local std::size_t StepBudget::left = 0;
thread_local std::stop_token StepBudget::stop;

// CGAL uses these overloads for this mesh instead of its own functions. CGAL's output builder would refuse
// open operands, although its classification by edges suffices for patches of solids. Solids are checked to
// be closed and outward before this point, and patches have the winding of their solids.
inline bool is_closed(const Mesh&) {
  return true;
}
template <typename Parameters>
bool is_outward_oriented(const Mesh&, const Parameters&) {
  return true;
}
// Where surfaces nearly coincide, CGAL may link halfedges into rings in which its loops run forever.
inline void take_step() {
  if (StepBudget::left == 0) throw std::runtime_error("its loop along the surface does not end");
  constexpr std::size_t between_looks = 1 << 12;
  if (StepBudget::left % between_looks == 0 && StepBudget::stop.stop_requested()) throw BooleanStopped();
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

/// Maps the mesh's points to CGAL's. CGAL's own map for OpenMesh converts points to float.
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

/// Marks edges on the cut, by number. New edges appear while cutting.
struct CutEdges {
  using category = boost::read_write_property_map_tag;
  using key_type = boost::graph_traits<Mesh>::edge_descriptor;
  using value_type = bool;
  using reference = bool;
  std::vector<bool>* on_cut = nullptr;

  friend bool get(const CutEdges& map, key_type e) {
    const auto i = static_cast<std::size_t>(e.idx());
    return i < map.on_cut->size() && (*map.on_cut)[i];
  }
  friend void put(const CutEdges& map, key_type e, bool is_on_cut) {
    const auto i = static_cast<std::size_t>(e.idx());
    if (i >= map.on_cut->size()) map.on_cut->resize(i + 1, false);
    (*map.on_cut)[i] = is_on_cut;
  }
};

/// Sheets up to this distance apart form a film: without rounding they would coincide. The operands' points
/// are rounded by half a unit of the last place of the largest coordinate, wherever the film itself lies; new
/// points add the same error again.
double film_thickness(const Mesh& a, const Mesh& b) {
  double reach = 0.0;
  for (const Mesh* mesh : {&a, &b})
    for (const auto v : mesh->vertices()) reach = std::max(reach, mesh->point(v).max_abs());
  return 4.0 * std::numeric_limits<double>::epsilon() * reach;
}

struct Films {
  std::size_t dropped = 0;
  bool has_open = false;  ///< there are also films with a border, which are not deleted
};

/// Deletes closed shells that are films: their volume is at most the thickness times their area.
Films drop_films(Mesh& mesh, double thickness) {
  std::vector<bool> seen(mesh.n_faces(), false);
  std::vector<Mesh::FaceHandle> shell;
  Films films;
  for (const auto seed : mesh.faces()) {
    if (seen[static_cast<std::size_t>(seed.idx())]) continue;
    seen[static_cast<std::size_t>(seed.idx())] = true;
    shell.assign(1, seed);
    const Mesh::Point origin = mesh.point(mesh.to_vertex_handle(mesh.halfedge_handle(seed)));
    double volume = 0.0, area = 0.0, border = 0.0;
    for (std::size_t next = 0; next < shell.size(); ++next) {
      Mesh::HalfedgeHandle h = mesh.halfedge_handle(shell[next]);
      std::array<Mesh::Point, 3> p;
      for (Mesh::Point& corner : p) {
        corner = mesh.point(mesh.to_vertex_handle(h)) - origin;
        const Mesh::FaceHandle beyond = mesh.opposite_face_handle(h);
        if (!beyond.is_valid()) border += mesh.calc_edge_length(h);
        if (beyond.is_valid() && !seen[static_cast<std::size_t>(beyond.idx())]) {
          seen[static_cast<std::size_t>(beyond.idx())] = true;
          shell.push_back(beyond);
        }
        h = mesh.next_halfedge_handle(h);
      }
      const Mesh::Point normal = OpenMesh::cross(p[1] - p[0], p[2] - p[0]);
      volume += OpenMesh::dot(p[0], normal) / 6.0;
      area += 0.5 * normal.norm();
    }
    films.has_open = films.has_open || (border > 0.0 && area <= thickness * border);
    if (border > 0.0 || std::abs(volume) > thickness * area) continue;
    ++films.dropped;
    for (const Mesh::FaceHandle face : shell) mesh.delete_face(face, true);
  }
  return films;
}

/// One point of each part that has no edge on the cut; the point belonged to the operand, so its number is
/// below `known`. Parts are connected across edges.
std::vector<std::uint32_t> uncut_parts(const Mesh& mesh, const std::vector<bool>& on_cut, std::size_t known) {
  std::vector<bool> seen(mesh.n_faces(), false);
  std::vector<Mesh::FaceHandle> flood;
  std::vector<std::uint32_t> uncut;
  for (const auto seed : mesh.faces()) {
    if (seen[static_cast<std::size_t>(seed.idx())]) continue;
    seen[static_cast<std::size_t>(seed.idx())] = true;
    flood.assign(1, seed);
    bool is_cut = false;
    std::size_t point = known;
    while (!flood.empty()) {
      const Mesh::FaceHandle face = flood.back();
      flood.pop_back();
      for (auto side = mesh.cfh_begin(face); side != mesh.cfh_end(face); ++side) {
        const auto edge = static_cast<std::size_t>(mesh.edge_handle(*side).idx());
        is_cut = is_cut || (edge < on_cut.size() && on_cut[edge]);
        point = std::min(point, static_cast<std::size_t>(mesh.to_vertex_handle(*side).idx()));
        const Mesh::FaceHandle beyond = mesh.opposite_face_handle(*side);
        if (!beyond.is_valid() || seen[static_cast<std::size_t>(beyond.idx())]) continue;
        seen[static_cast<std::size_t>(beyond.idx())] = true;
        flood.push_back(beyond);
      }
    }
    if (!is_cut) uncut.push_back(static_cast<std::uint32_t>(point));
  }
  return uncut;
}

using PlainTriangles = PointTriangles<glm::dvec3>;

PlainTriangles plain(const Mesh& mesh) {
  Triangles triangles = triangles_of(mesh);
  return {std::move(triangles.points_mm), std::move(triangles.faces)};
}

/// Corrects the results by correct_contrary_shells(). Does not change results without such shells.
void correct_results(const Mesh& a, const Mesh& b, std::array<Mesh, 4>& meshes,
                     const std::array<bool, 4>& is_there) {
  const auto less = [](const glm::dvec3& p, const glm::dvec3& q) {
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  };
  std::array<std::optional<PlainTriangles>, 4> results;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    if (is_there[i]) results[i] = plain(meshes[i]);
  if (correct_contrary_shells(plain(a), plain(b), results, less) == 0) return;
  for (std::size_t i = 0; i < meshes.size(); ++i)
    if (results[i])
      meshes[i] = mesh_of(Triangles{std::move(results[i]->points), std::move(results[i]->faces)});
}

/// A result in a canonical order. Triangles that rounding left without area are removed, because a further
/// Boolean would fail at them.
Triangles finished(const Mesh& mesh) {
  Triangles triangles = in_coordinate_order(mesh);
  if (!has_flat_triangles(triangles)) return triangles;
  Mesh ordered = mesh_of(triangles);
  take_out_flat_triangles(ordered);
  return in_coordinate_order(ordered);
}

/// Limit of steps, far above the number in any correct corefinement: about 100 steps per triangle (measured),
/// and n^2 for a fan of n triangles around a point. A loop in an endless ring makes all these steps, each of
/// which takes a nanosecond.
std::size_t step_limit(const Mesh& a, const Mesh& b) {
  const std::size_t triangles = a.n_faces() + b.n_faces();
  return std::min<std::size_t>(10'000 * triangles, 100'000'000 + 500 * triangles);
}

/// Corefines copies of the operands once.
Corefined attempt(Mesh a, Mesh b, const Wanted& wanted, bool refuse_self_intersection) {
  static_assert(int{pmp::Corefinement::UNION} == int{of_union} &&
                int{pmp::Corefinement::INTERSECTION} == int{of_intersection} &&
                int{pmp::Corefinement::TM1_MINUS_TM2} == int{of_a_minus_b} &&
                int{pmp::Corefinement::TM2_MINUS_TM1} == int{of_b_minus_a});
  Corefined corefined;
  for (Mesh* operand : {&a, &b}) corefined.flat += take_out_flat_triangles(*operand).taken();
  std::array<Mesh, 4> meshes;
  std::array<boost::optional<Mesh*>, 4> output;
  for (std::size_t i = 0; i < output.size(); ++i)
    if (wanted[i]) output[i] = &meshes[i];
  const auto to = [&](std::size_t i) { return CGAL::parameters::vertex_point_map(PointMap{&meshes[i]}); };
  const double thickness = film_thickness(a, b);
  const std::array<std::size_t, 2> points{a.n_vertices(), b.n_vertices()};
  std::vector<bool> cut_a, cut_b;
  StepBudget::left = step_limit(a, b);
  const std::array<bool, 4> manifold = pmp::corefine_and_compute_boolean_operations(
      a, b, output,
      CGAL::parameters::vertex_point_map(PointMap{&a})
          .edge_is_constrained_map(CutEdges{&cut_a})
          .throw_on_self_intersection(refuse_self_intersection),
      CGAL::parameters::vertex_point_map(PointMap{&b}).edge_is_constrained_map(CutEdges{&cut_b}),
      std::make_tuple(to(0), to(1), to(2), to(3)));

  std::array<bool, 4> is_there{};
  for (std::size_t i = 0; i < output.size(); ++i) {
    is_there[i] = output[i] && manifold[i];
    if (!is_there[i]) continue;
    meshes[i].garbage_collection();
    check_joins(triangles_of(meshes[i]));
  }
  corefined.uncut = {uncut_parts(a, cut_a, points[0]), uncut_parts(b, cut_b, points[1])};
  // Shells can only coincide if both operands have parts without an edge on the cut.
  if (!corefined.uncut[0].empty() && !corefined.uncut[1].empty()) {
    for (Mesh* operand : {&a, &b}) operand->garbage_collection();
    correct_results(a, b, meshes, is_there);
  }
  for (std::size_t i = 0; i < output.size(); ++i) {
    if (!is_there[i]) continue;
    const Films films = drop_films(meshes[i], thickness);
    if (films.dropped > 0) meshes[i].garbage_collection();
    corefined.films[i] = films.dropped;
    corefined.has_open_film = corefined.has_open_film || films.has_open;
    corefined.results[i] = finished(meshes[i]);
  }
  return corefined;
}

}  // namespace

/// CGAL reports three failures by exceptions: an operand that intersects itself, constraints that cross
/// within a triangle (the same, detected later), and broken invariants.
Corefined corefine(const Mesh& a, const Mesh& b, const Wanted& wanted, const std::stop_token& stop) {
  Corefined failed;
  StepBudget::stop = stop;
  for (const bool strict : {true, false}) {
    try {
      Corefined corefined = attempt(a, b, wanted, strict);
      corefined.meets_itself = !strict;
      return corefined;
    } catch (const BooleanStopped&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const pmp::Corefinement::Self_intersection_exception&) {
      failed.failure = "an operand intersects itself where the other cuts it";
    } catch (const std::exception& e) {
      failed.failure = std::string("corefinement broke off: ") + e.what();
    }
  }
  return failed;
}

}  // namespace octotomy::brep
