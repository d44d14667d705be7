// SPDX-License-Identifier: AGPL-3.0-or-later

// octotomy-mesh3: one run of CGAL's Mesh_3, fed and read by mesher_process.cpp. The request's switches are
// Mesh3Sizes, its hole points are the points of the surface to start from, its sizes one a point. Nothing
// ends by the clock, so that the answer is the same on any machine. Source: Alliez, Jamin, Rineau, Tayeb,
// Tournois, Yvinec, "3D mesh generation", CGAL user and reference manual 5.5; slivers are exuded as Cheng et
// al. do, "Sliver exudation", JACM 47(5), 2000.

#include <CGAL/AABB_face_graph_triangle_primitive.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_3.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/make_mesh_3.h>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "convert/tet/mesh3_criteria.h"
#include "convert/tet/mesh3_exchange.h"
#include "convert/tet/mesher_child.h"

using octotomy::convert::Mesh3Sizes;
using octotomy::convert::MesherRequest;
using octotomy::convert::read_all;
namespace convert = octotomy::convert;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

using Domain = convert::StartingFrom<CGAL::Polyhedral_mesh_domain_3<Surface, Kernel>, Point>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;

/// The size at a point: that of the surface's nearest point, between its triangle's corners by the
/// barycentric coordinates, and more with the way from there.
class SizeField {
 public:
  using FT = Kernel::FT;

  SizeField(const Surface& surface, const std::vector<double>& sizes_mm, double grading)
      : surface_(surface), sizes_mm_(sizes_mm), grading_(grading) {
    tree_.insert(faces(surface).first, faces(surface).second, surface);
    tree_.accelerate_distance_queries();
  }

  FT operator()(const Point& p) const {
    const auto [foot, face] = tree_.closest_point_and_primitive(p);
    double size_mm = 0.0;
    double weights = 0.0;
    auto halfedge = surface_.halfedge(face);
    for (int i = 0; i < 3; ++i, halfedge = surface_.next(halfedge)) {
      // The weight of the corner opposite the side is the area between the side and the foot.
      const Point& a = surface_.point(surface_.source(halfedge));
      const Point& b = surface_.point(surface_.target(halfedge));
      const double weight = std::sqrt(CGAL::squared_area(a, b, foot));
      size_mm += weight * sizes_mm_[surface_.target(surface_.next(halfedge))];
      weights += weight;
    }
    // A triangle without area takes the size of one of its corners.
    size_mm = weights > 0.0 ? size_mm / weights : sizes_mm_[surface_.target(halfedge)];
    return size_mm + grading_ * std::sqrt(CGAL::squared_distance(p, foot));
  }

 private:
  using Primitive = CGAL::AABB_face_graph_triangle_primitive<Surface>;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

  const Surface& surface_;
  const std::vector<double>& sizes_mm_;
  double grading_;
  Tree tree_;
};

/// A share of the field, up to a length, as Mesh_3 asks for it.
struct Sizes {
  using FT = Kernel::FT;
  const SizeField& field;
  double share = 1.0;
  double most_mm = std::numeric_limits<double>::infinity();

  template <typename Index>
  FT operator()(const Point& p, int /*dimension*/, const Index& /*index*/) const {
    return std::min(share * field(p), most_mm);
  }
};

/// A share of the field, under which nothing is refined.
struct Least {
  const SizeField& field;
  double share = 1.0;

  double operator()(const Point& p) const { return share * field(p); }
};

bool read_surface(const MesherRequest& request, Surface& surface) {
  std::vector<Point> points;
  if (!convert::read_points(request.points, points) ||
      request.triangles > std::numeric_limits<std::uint32_t>::max() / 3)
    return false;
  std::vector<std::uint32_t> corners(3 * request.triangles);
  if (!read_all(corners.data(), corners.size() * sizeof(std::uint32_t))) return false;
  for (const Point& p : points) surface.add_vertex(p);
  for (std::size_t i = 0; i < corners.size(); i += 3)
    if (surface.add_face(Surface::Vertex_index(corners[i]), Surface::Vertex_index(corners[i + 1]),
                         Surface::Vertex_index(corners[i + 2])) == Surface::null_face())
      throw std::runtime_error("triangle " + std::to_string(i / 3) + " does not join the others");
  return true;
}

struct Request {
  Mesh3Sizes sizes;
  Surface surface;
  std::vector<Point> start;
  std::vector<double> sizes_mm;
};

bool read(const MesherRequest& request, Request& read) {
  if (std::sscanf(request.switches.data(), convert::mesh3_switches, &read.sizes.distance, &read.sizes.cell,
                  &read.sizes.grading, &read.sizes.max_cell_mm) != 4 ||
      request.sizes != request.points || !read_surface(request, read.surface) ||
      !convert::read_points(request.holes, read.start))
    return false;
  read.sizes_mm.resize(request.sizes);
  return read_all(read.sizes_mm.data(), read.sizes_mm.size() * sizeof(double));
}

Complex mesh(const Request& request) {
  namespace p = CGAL::parameters;
  const Domain domain(request.start, request.surface);
  const Mesh3Sizes& sizes = request.sizes;
  const SizeField field(request.surface, request.sizes_mm, sizes.grading);
  // A twentieth of the elements' target size there.
  constexpr double least_share = 0.05;
  const Least least{field, least_share};
  const convert::FacetsDownTo<Triangulation, Least> facets(
      {convert::safe_facet_angle_deg, Sizes{field}, Sizes{field, sizes.distance}}, least);
  const convert::CellsDownTo<Triangulation, Least> cells(
      {convert::safe_radius_edge, Sizes{field, sizes.cell, sizes.max_cell_mm}}, least);
  const convert::CriteriaDownTo<Triangulation, Least> criteria(facets, cells);
  // No limit of time, not even CGAL's own. Flatter elements than this are exuded; moving nodes mends the
  // rest.
  constexpr double sliver_deg = 10.0;
  return CGAL::make_mesh_3<Complex>(domain, criteria, p::no_perturb(),
                                    p::exude(p::time_limit = 0.0, p::sliver_bound = sliver_deg));
}

bool answer(const convert::MesherTask& task) {
  Request request;
  return read(task.request, request) &&
         convert::write_answer(task.answer_file, mesh(request), convert::AnswerLabels::none);
}

}  // namespace

int main() {
  convert::run_mesher(answer);
}
