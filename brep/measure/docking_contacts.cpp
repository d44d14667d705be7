// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Cut the part's triangles into pieces no longer than the spacing; their corners are the candidates, those
//   of large triangles first.
// 2 A candidate near the objects whose foot faces it becomes a contact, one in each cube of the spacing's
//   edge.
// 3 Each normal becomes the mean of its neighbours'.
#include "brep/measure/docking_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <tuple>

#include "brep/mesh/distance.h"
#include "brep/mesh/error.h"

namespace octotomy::brep {
namespace {

/// Surfaces face each other, or face a push, if their directions are opposite to within 60 degrees.
constexpr double least_facing = 0.5;
/// Normals within 37 degrees belong to one smooth face.
constexpr double least_alike = 0.8;

using TrianglePoints = std::array<glm::dvec3, 3>;

glm::dvec3 across(const TrianglePoints& triangle) {
  return glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
}

std::optional<glm::dvec3> normal_of(const TrianglePoints& triangle) {
  const glm::dvec3 normal = across(triangle);
  const double length = glm::length(normal);
  if (!(length > 0.0)) return std::nullopt;
  return normal / length;
}

TrianglePoints triangle_of(const Triangles& triangles, std::size_t face) {
  const auto& [a, b, c] = triangles.faces[face];
  return {triangles.points_mm[a], triangles.points_mm[b], triangles.points_mm[c]};
}

/// Selects the first candidate in each cube of a grid.
class Thinning {
 public:
  explicit Thinning(double edge_mm) : edge_mm_(edge_mm) {}
  bool is_first(const glm::dvec3& p_mm) {
    const glm::dvec3 at = glm::floor(p_mm / edge_mm_);
    return taken_.emplace(at.x, at.y, at.z).second;
  }

 private:
  double edge_mm_;
  std::set<std::tuple<double, double, double>> taken_;
};

/// Calls `visit` with points inside a triangle: the corners of equal pieces whose sides are no longer than
/// the spacing, or the middle of a triangle that is one piece.
template <typename Visit>
void for_pieces(const TrianglePoints& triangle, double spacing_mm, const Visit& visit) {
  const auto& [a, b, c] = triangle;
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const int parts = static_cast<int>(std::ceil(longest / spacing_mm));
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j) {
      const bool is_corner = (i == 0 && j == 0) || i == parts || j == parts;
      if (parts > 1 && !is_corner) visit(a + (b - a) * (1.0 * i / parts) + (c - a) * (1.0 * j / parts));
    }
  if (parts == 1) visit((a + b + c) / 3.0);
}

/// A place of the part's surface with its outward normal.
struct Place {
  glm::dvec3 p_mm{0.0}, normal{0.0};
};

/// Places on the given triangles: first their corners, those of the largest triangles before others; then
/// points inside them.
std::vector<Place> places_of(const Triangles& surface, double spacing_mm,
                             const std::vector<std::uint32_t>& faces) {
  std::vector<std::pair<double, std::uint32_t>> by_size;
  for (const std::uint32_t face : faces)
    by_size.emplace_back(-glm::length(across(triangle_of(surface, face))), face);
  std::sort(by_size.begin(), by_size.end());
  std::vector<Place> places;
  for (const bool are_corners : {true, false})
    for (const auto& [size, face] : by_size) {
      const TrianglePoints triangle = triangle_of(surface, face);
      const std::optional<glm::dvec3> normal = normal_of(triangle);
      if (!normal) continue;
      if (are_corners)
        for (const glm::dvec3& corner : triangle) places.push_back({corner, *normal});
      else
        for_pieces(triangle, spacing_mm, [&](const glm::dvec3& p) { places.push_back({p, *normal}); });
    }
  return places;
}

bool overlaps(const TrianglePoints& triangle, const glm::dvec3& low_mm, const glm::dvec3& high_mm) {
  const auto& [a, b, c] = triangle;
  return glm::all(glm::lessThanEqual(glm::min(glm::min(a, b), c), high_mm)) &&
         glm::all(glm::greaterThanEqual(glm::max(glm::max(a, b), c), low_mm));
}

/// The numbers of the triangles whose boxes overlap a box.
std::vector<std::uint32_t> faces_in(const Triangles& surface, const glm::dvec3& low_mm,
                                    const glm::dvec3& high_mm) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t face = 0; face < surface.faces.size(); ++face)
    if (overlaps(triangle_of(surface, face), low_mm, high_mm)) found.push_back(face);
  return found;
}

/// The objects' triangles within a box.
Triangles near_triangles(const std::vector<Solid>& objects, const glm::dvec3& low_mm,
                         const glm::dvec3& high_mm) {
  Triangles near;
  for (const Solid& object : objects) {
    const Triangles& all = object.triangles();
    for (const std::uint32_t face : faces_in(all, low_mm, high_mm)) {
      const auto first = static_cast<std::uint32_t>(near.points_mm.size());
      for (const glm::dvec3& corner : triangle_of(all, face)) near.points_mm.push_back(corner);
      near.faces.push_back({first, first + 1, first + 2});
    }
  }
  return near;
}

void smooth_normals(std::vector<DockingContact>& contacts, double within_mm) {
  std::vector<glm::dvec3> smooth;
  for (const DockingContact& one : contacts) {
    glm::dvec3 sum(0.0);
    for (const DockingContact& other : contacts)
      if (glm::distance(one.p_mm, other.p_mm) <= within_mm &&
          glm::dot(one.normal, other.normal) > least_alike)
        sum += other.normal;
    smooth.push_back(glm::normalize(sum));
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i].normal = smooth[i];
}

}  // namespace

std::vector<DockingContact> docking_contacts(const Solid& part, const std::vector<Solid>& objects,
                                             const DockingContactsOptions& options) {
  if (!(options.within_mm > 0.0)) throw InvalidInput("the largest gap of a contact must be above 0 mm");
  if (!(options.spacing_mm > 0.0)) throw InvalidInput("the spacing of contacts must be above 0 mm");
  if (!(options.smooth_mm >= 0.0)) throw InvalidInput("normals cannot be smoothed over less than 0 mm");
  if (part.empty() || objects.empty()) throw InvalidInput("contacts need a part and an object");
  const glm::dvec3 margin(options.within_mm);
  const Triangles near = near_triangles(objects, part.size().low_mm - margin, part.size().high_mm + margin);
  if (near.faces.empty()) return {};
  glm::dvec3 low = near.points_mm.front(), high = low;
  for (const glm::dvec3& p : near.points_mm) low = glm::min(low, p), high = glm::max(high, p);
  const std::vector<Place> places = places_of(part.triangles(), options.spacing_mm,
                                              faces_in(part.triangles(), low - margin, high + margin));
  if (places.empty()) return {};
  options.progress.at(0.2);
  std::vector<glm::dvec3> points;
  points.reserve(places.size());
  for (const Place& place : places) points.push_back(place.p_mm);
  const std::vector<Foot> feet = SurfaceTree(near, SurfaceTree::Build::Hasty).feet(points);
  options.progress.at(0.8);
  std::vector<DockingContact> contacts;
  Thinning thinning(options.spacing_mm);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (feet[i].distance_mm > options.within_mm) continue;
    const std::optional<glm::dvec3> normal = normal_of(triangle_of(near, feet[i].face));
    if (!normal || glm::dot(*normal, places[i].normal) > -least_facing) continue;
    if (thinning.is_first(feet[i].p_mm)) contacts.push_back({feet[i].p_mm, *normal, feet[i].distance_mm});
  }
  smooth_normals(contacts, options.smooth_mm);
  options.progress.at(1.0);
  return contacts;
}

std::vector<glm::dvec3> pushed_surface(const Solid& part, const glm::dvec3& push, double spacing_mm) {
  if (!(spacing_mm > 0.0)) throw InvalidInput("the spacing of points must be above 0 mm");
  const std::vector<Place> places = places_of(
      part.triangles(), spacing_mm, faces_in(part.triangles(), part.size().low_mm, part.size().high_mm));
  std::vector<glm::dvec3> points;
  Thinning thinning(spacing_mm);
  for (const Place& place : places)
    if (glm::dot(place.normal, push) <= -least_facing && thinning.is_first(place.p_mm))
      points.push_back(place.p_mm);
  return points;
}

}  // namespace octotomy::brep
