// SPDX-License-Identifier: AGPL-3.0-or-later
// 1 check whether the solid is its convex hull; 2 cut a box around it by the plane of each side, moved
// inward: the box is a list of polygons, one for each face, and the points of a cut form a new polygon; 3
// take the hull of the polygons' corners, which is closed and convex by exact predicates, however corners are
// rounded.
#include "brep/shape/convex_inset.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "brep/mesh/distance.h"

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using HullMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Polygon = std::vector<glm::dvec3>;

constexpr std::size_t most_sides = std::size_t{1} << 12;

/// Places nearer to each other than this are one place. Far above the rounding of points and of a few cuts,
/// and far below any measured length.
double slack_mm(const Size& size) {
  return 0x1p-30 * glm::length(size.high_mm - size.low_mm);
}

struct SidePlane {
  glm::dvec3 normal{0.0};
  double along_mm = 0.0;  ///< p . normal of the points of the plane
};

/// The triangles of the convex hull; none where all points lie in a plane.
Triangles hull_of(const std::vector<glm::dvec3>& points_mm) {
  std::vector<Kernel::Point_3> points;
  for (const glm::dvec3& p : points_mm) points.emplace_back(p.x, p.y, p.z);
  Triangles hull;
  if (points.size() < 4) return hull;
  // Without four points that span a volume, the hull would be no mesh.
  const auto far = std::find_if(points.begin(), points.end(), [&](const auto& p) { return p != points[0]; });
  if (far == points.end()) return hull;
  const auto beside = std::find_if(points.begin(), points.end(),
                                   [&](const auto& p) { return !CGAL::collinear(points[0], *far, p); });
  if (beside == points.end() || std::all_of(points.begin(), points.end(), [&](const auto& p) {
        return CGAL::coplanar(points[0], *far, *beside, p);
      }))
    return hull;
  HullMesh mesh;
  CGAL::convex_hull_3(points.begin(), points.end(), mesh);
  std::map<HullMesh::Vertex_index, std::uint32_t> numbers;
  for (const auto vertex : mesh.vertices()) {
    const Kernel::Point_3& p = mesh.point(vertex);
    numbers.emplace(vertex, static_cast<std::uint32_t>(hull.points_mm.size()));
    hull.points_mm.emplace_back(p.x(), p.y(), p.z());
  }
  for (const auto face : mesh.faces()) {
    std::vector<std::uint32_t> corners;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face)))
      corners.push_back(numbers.at(vertex));
    for (std::size_t i = 2; i < corners.size(); ++i)
      hull.faces.push_back({corners[0], corners[i - 1], corners[i]});
  }
  return hull;
}

/// Whether no edge bends inward by more than the slack. Cost: linear. For most solids that are not convex,
/// the test ends here.
bool bends_outward(const Solid& solid, double slack) {
  const Triangles& surface = solid.triangles();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> opposite;
  for (const auto& face : surface.faces)
    for (std::size_t k = 0; k < 3; ++k) opposite[{face[k], face[(k + 1) % 3]}] = face[(k + 2) % 3];
  return std::all_of(surface.faces.begin(), surface.faces.end(), [&](const auto& face) {
    const glm::dvec3 &a = surface.points_mm[face[0]], &b = surface.points_mm[face[1]],
                     &c = surface.points_mm[face[2]];
    const glm::dvec3 across = glm::cross(b - a, c - a);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = opposite.find({face[(k + 1) % 3], face[k]});
      if (found == opposite.end()) return false;
      if (glm::dot(surface.points_mm[found->second] - a, across) > slack * glm::length(across)) return false;
    }
    return true;
  });
}

/// The hull of a solid that is convex, or no triangles.
Triangles hull_of_convex(const Solid& solid) {
  const double slack = slack_mm(solid.size());
  if (!bends_outward(solid, slack)) return {};
  Triangles hull = hull_of(solid.triangles().points_mm);
  if (hull.faces.empty()) return {};
  const Size size = size_of(hull);
  if (std::abs(size.volume_mm3 - solid.size().volume_mm3) > slack * size.area_mm2) return {};
  const std::vector<double> off_mm = SurfaceTree(hull).distances_mm(solid.triangles().points_mm);
  if (std::any_of(off_mm.begin(), off_mm.end(), [&](double off) { return off > slack; })) return {};
  return hull;
}

/// The planes of the hull's triangles; neighbours in one plane count once.
std::vector<SidePlane> sides_of(const Triangles& hull) {
  std::vector<std::pair<double, SidePlane>> by_area;
  for (const auto& [i, j, k] : hull.faces) {
    const glm::dvec3 &a = hull.points_mm[i], &b = hull.points_mm[j], &c = hull.points_mm[k];
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double area = glm::length(across);
    if (area > 0.0) by_area.push_back({area, {across / area, glm::dot(across / area, (a + b + c) / 3.0)}});
  }
  // The largest triangles define their planes most accurately.
  std::stable_sort(by_area.begin(), by_area.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<SidePlane> sides;
  constexpr double same = 1e-9;  // of unit normals, far above their rounding
  std::map<std::array<long long, 3>, std::vector<SidePlane>> cells;
  for (const auto& [area, side] : by_area) {
    const glm::dvec3 scaled = side.normal / (4.0 * same);
    const auto cell = [&](const glm::dvec3& p) {
      return std::array{std::llround(p.x), std::llround(p.y), std::llround(p.z)};
    };
    bool is_known = false;
    for (int corner = 0; corner < 8 && !is_known; ++corner) {
      const glm::dvec3 off(corner & 1 ? 0.25 : -0.25, corner & 2 ? 0.25 : -0.25, corner & 4 ? 0.25 : -0.25);
      const auto known = cells.find(cell(scaled + off));
      is_known = known != cells.end() &&
                 std::any_of(known->second.begin(), known->second.end(), [&](const SidePlane& other) {
                   return glm::distance(other.normal, side.normal) <= same;
                 });
    }
    if (is_known) continue;
    cells[cell(scaled)].push_back(side);
    sides.push_back(side);
  }
  return sides;
}

/// The polygons of a box.
std::vector<Polygon> box_about(const Size& size) {
  const glm::dvec3 margin = glm::dvec3(0.25 * glm::length(size.high_mm - size.low_mm));
  const glm::dvec3 low = size.low_mm - margin, high = size.high_mm + margin;
  std::vector<Polygon> faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_high : {false, true}) {
      Polygon face;
      for (const auto& [u, v] : {std::pair{false, false}, {true, false}, {true, true}, {false, true}}) {
        glm::dvec3 p;
        p[axis] = is_high ? high[axis] : low[axis];
        p[(axis + 1) % 3] = u ? high[(axis + 1) % 3] : low[(axis + 1) % 3];
        p[(axis + 2) % 3] = v ? high[(axis + 2) % 3] : low[(axis + 2) % 3];
        face.push_back(p);
      }
      faces.push_back(std::move(face));
    }
  return faces;
}

/// The points sorted by their directions from the middle of all, without repeated ones.
Polygon ring_of(Polygon points, const glm::dvec3& normal, double slack) {
  glm::dvec3 middle(0.0);
  for (const glm::dvec3& p : points) middle += p / static_cast<double>(points.size());
  const glm::dvec3 other = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(other, normal)), v = glm::cross(normal, u);
  const auto angle = [&](const glm::dvec3& p) {
    return std::atan2(glm::dot(p - middle, v), glm::dot(p - middle, u));
  };
  std::sort(points.begin(), points.end(),
            [&](const glm::dvec3& a, const glm::dvec3& b) { return angle(a) < angle(b); });
  Polygon ring;
  for (const glm::dvec3& p : points)
    if (ring.empty() || glm::distance(ring.back(), p) > slack) ring.push_back(p);
  if (ring.size() > 1 && glm::distance(ring.front(), ring.back()) <= slack) ring.pop_back();
  return ring;
}

/// Removes the parts of faces above the plane.
void cut(std::vector<Polygon>& faces, const SidePlane& plane, double slack) {
  const auto height = [&](const glm::dvec3& p) { return glm::dot(p, plane.normal) - plane.along_mm; };
  Polygon cut_points;
  bool is_cut = false;
  std::vector<Polygon> kept;
  kept.reserve(faces.size() + 1);
  for (Polygon& face : faces) {
    const auto [low, high] =
        std::minmax_element(face.begin(), face.end(),
                            [&](const glm::dvec3& a, const glm::dvec3& b) { return height(a) < height(b); });
    if (height(*high) <= slack) {
      for (const glm::dvec3& p : face)
        if (height(p) >= -slack) cut_points.push_back(p);
      kept.push_back(std::move(face));
      continue;
    }
    is_cut = true;
    if (height(*low) >= -slack) continue;
    Polygon below;
    for (std::size_t i = 0; i < face.size(); ++i) {
      const glm::dvec3 &p = face[i], &q = face[(i + 1) % face.size()];
      const double at_p = height(p), at_q = height(q);
      if (at_p <= slack) below.push_back(p);
      if (std::abs(at_p) <= slack) cut_points.push_back(p);
      if ((at_p < -slack && at_q > slack) || (at_p > slack && at_q < -slack)) {
        cut_points.push_back(p + at_p / (at_p - at_q) * (q - p));
        below.push_back(cut_points.back());
      }
    }
    if (below.size() >= 3) kept.push_back(std::move(below));
  }
  if (is_cut && cut_points.size() >= 3) {
    Polygon ring = ring_of(std::move(cut_points), plane.normal, slack);
    if (ring.size() >= 3) kept.push_back(std::move(ring));
  }
  faces = std::move(kept);
}

/// The corners of all faces; corners that only rounding separates become one.
std::vector<glm::dvec3> corners_of(const std::vector<Polygon>& faces, double slack) {
  std::vector<glm::dvec3> corners;
  std::map<std::array<long long, 3>, std::vector<glm::dvec3>> cells;
  const auto cell = [&](const glm::dvec3& p) {
    return std::array{std::llround(p.x / (4.0 * slack)), std::llround(p.y / (4.0 * slack)),
                      std::llround(p.z / (4.0 * slack))};
  };
  for (const Polygon& face : faces)
    for (const glm::dvec3& p : face) {
      bool is_known = false;
      for (int corner = 0; corner < 8 && !is_known; ++corner) {
        const glm::dvec3 off(corner & 1 ? slack : -slack, corner & 2 ? slack : -slack,
                             corner & 4 ? slack : -slack);
        const auto known = cells.find(cell(p + off));
        is_known = known != cells.end() &&
                   std::any_of(known->second.begin(), known->second.end(),
                               [&](const glm::dvec3& q) { return glm::distance(p, q) <= slack; });
      }
      if (is_known) continue;
      cells[cell(p)].push_back(p);
      corners.push_back(p);
    }
  return corners;
}

}  // namespace

std::optional<Solid> convex_inset(const Solid& solid, double depth_mm, const Progress& progress) {
  assert(depth_mm > 0.0);
  if (solid.empty()) return std::nullopt;
  const Triangles hull = hull_of_convex(solid);
  if (hull.faces.empty()) return std::nullopt;
  const std::vector<SidePlane> sides = sides_of(hull);
  if (sides.size() > most_sides) return std::nullopt;
  const double slack = 0.25 * slack_mm(solid.size());
  std::vector<Polygon> faces = box_about(solid.size());
  for (std::size_t i = 0; i < sides.size() && !faces.empty(); ++i) {
    if (i % 64 == 0) progress.at(static_cast<double>(i) / static_cast<double>(sides.size()));
    cut(faces, {sides[i].normal, sides[i].along_mm - depth_mm}, slack);
  }
  const Triangles inset = hull_of(corners_of(faces, slack));
  if (inset.faces.empty() || !(size_of(inset).volume_mm3 > 0.0)) return Solid();
  return trusted_solid(inset, Proof::Construction);
}

}  // namespace octotomy::brep
