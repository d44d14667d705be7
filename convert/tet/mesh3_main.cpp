// SPDX-License-Identifier: AGPL-3.0-or-later

// octotomy-mesh3: one run of CGAL's Mesh_3, fed and read by mesher_process.cpp. The request's switches are
// Mesh3Sizes, its hole points are the points of the surface to start from, its sizes are one for each point.
// No step ends by the clock, so the answer is the same on any machine. Source: Alliez, Jamin, Rineau, Tayeb,
// Tournois, Yvinec, "3D mesh generation", CGAL user and reference manual 5.5; slivers are exuded as Cheng et
// al. do, "Sliver exudation", JACM 47(5), 2000.

#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <tbb/task_arena.h>
#include <unordered_set>
#include <vector>

#include "convert/tet/mesh3_criteria.h"
#include "convert/tet/mesh3_exchange.h"
#include "convert/tet/mesher_child.h"
#include "convert/tet/surface_domain.h"

using octotomy::convert::Mesh3Sizes;
using octotomy::convert::MesherRequest;
using octotomy::convert::read_all;
namespace convert = octotomy::convert;

namespace {

using Point = convert::SurfaceDomain::Point_3;
using Domain = convert::StartingFrom<convert::SurfaceDomain, Point>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;

/// The size at a point: the size at the nearest point of the surface, interpolated between its triangle's
/// corners, plus a share of the distance from there.
class SizeField {
 public:
  using FT = Domain::FT;

  SizeField(const octotomy::brep::Triangles& surface, const octotomy::brep::SurfaceTree& tree,
            const std::vector<double>& sizes_mm, double grading)
      : surface_(surface), tree_(tree), sizes_mm_(sizes_mm), grading_(grading) {}

  FT operator()(const Point& p) const {
    // Mesh_3 queries a point twice, and near points one after the other; most are on the surface.
    const glm::dvec3 p_mm(p.x(), p.y(), p.z());
    if (p_mm == asked_mm_) return size_mm_;
    const octotomy::brep::Foot foot = tree_.foot(p_mm, nearest_, on_surface_mm);
    size_mm_ = grading_ * foot.distance_mm;
    for (int i = 0; i < 3; ++i)
      size_mm_ += foot.weights[i] * sizes_mm_[surface_.faces[foot.face][static_cast<std::size_t>(i)]];
    asked_mm_ = p_mm;
    return size_mm_;
  }

 private:
  static constexpr double on_surface_mm = 1e-9;

  const octotomy::brep::Triangles& surface_;
  const octotomy::brep::SurfaceTree& tree_;
  const std::vector<double>& sizes_mm_;
  double grading_;
  mutable std::uint32_t nearest_ = 0;
  mutable glm::dvec3 asked_mm_{std::numeric_limits<double>::infinity()};
  mutable double size_mm_ = 0.0;
};

/// A share of the field, at most a given length, in the form that Mesh_3 requires.
struct Sizes {
  using FT = Domain::FT;
  const SizeField& field;
  double share = 1.0;
  double most_mm = std::numeric_limits<double>::infinity();

  template <typename Index>
  FT operator()(const Point& p, int /*dimension*/, const Index& /*index*/) const {
    return std::min(share * field(p), most_mm);
  }
};

/// A share of the field; facets and cells with only shorter sides are not refined.
struct Least {
  const SizeField& field;
  double share = 1.0;

  double operator()(const Point& p) const { return share * field(p); }
};

bool read_surface(const MesherRequest& request, octotomy::brep::Triangles& surface) {
  std::vector<Point> points;
  if (!convert::read_points(request.points, points) ||
      request.triangles > std::numeric_limits<std::uint32_t>::max() / 3)
    return false;
  for (const Point& p : points) surface.points_mm.emplace_back(p.x(), p.y(), p.z());
  surface.faces.resize(request.triangles);
  if (!read_all(surface.faces.data(), surface.faces.size() * sizeof surface.faces[0])) return false;
  // Refuses a side along which two triangles run in the same direction.
  std::unordered_set<std::uint64_t> sides;
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i)
      if (!sides.insert(std::uint64_t{surface.faces[f][i]} << 32 | surface.faces[f][(i + 1) % 3]).second)
        throw std::runtime_error("triangle " + std::to_string(f) + " does not join the others");
  return true;
}

struct Request {
  Mesh3Sizes sizes;
  octotomy::brep::Triangles surface;
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
  // Starts no thread, because the memory limit might not allow one.
  using octotomy::brep::SurfaceTree;
  const SurfaceTree tree = tbb::task_arena(1).execute(
      [&] { return SurfaceTree(request.surface, SurfaceTree::Build::ForSegments); });
  const Domain domain(request.start, request.surface, tree);
  const Mesh3Sizes& sizes = request.sizes;
  const SizeField field(request.surface, tree, request.sizes_mm, sizes.grading);
  // Least length, as a share of the size of elements at the same point.
  constexpr double least_share = 0.05;
  const Least least{field, least_share};
  const convert::FacetsDownTo<Triangulation, Least> facets(
      {convert::safe_facet_angle_deg, Sizes{field}, Sizes{field, sizes.distance}}, least);
  const convert::CellsDownTo<Triangulation, Least> cells(
      {convert::safe_radius_edge, Sizes{field, sizes.cell, sizes.max_cell_mm}}, least);
  const convert::CriteriaDownTo<Triangulation, Least> criteria(facets, cells);
  // No limit of time, not even CGAL's own. Sliver exudation removes elements flatter than this; moving
  // nodes mends the rest.
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
