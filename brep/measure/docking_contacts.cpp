// SPDX-License-Identifier: AGPL-3.0-or-later
//
// 1 Cut the part's triangles into pieces no longer than the spacing; their corners are the candidates, those
//   of large triangles first.
// 2 A candidate near the objects whose foot faces it becomes a contact, one in each cube of the spacing's
//   edge.
// 3 Each normal becomes the mean of the objects' surface about it, as far as that faces the same way. The
//   surface beyond the part counts, too: a mean over contacts alone leans outward at the part's rim.
#include "brep/measure/docking_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tbb/parallel_for.h>
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

/// The objects' surface in pieces, for means of its normals.
class SurfacePieces {
 public:
  /// Of triangles, as far as they lie within a distance of places.
  SurfacePieces(const Triangles& surface, const std::vector<DockingContact>& places, double within_mm)
      : edge_mm_(within_mm) {
    std::set<Cell> wanted;
    for (const DockingContact& place : places)
      for_cells(cell_of(place.p_mm), [&](const Cell& cell) { wanted.insert(cell); });
    for (std::uint32_t face = 0; face < surface.faces.size(); ++face) {
      const TrianglePoints triangle = triangle_of(surface, face);
      if (touches(triangle, wanted)) split(triangle, wanted);
    }
  }

  /// The sum of the pieces' outward area vectors within a distance, at most that of the constructor, as far as
  /// `counts` accepts them.
  template <typename Counts>
  glm::dvec3 area_about(const glm::dvec3& p_mm, double within_mm, const Counts& counts) const {
    glm::dvec3 sum(0.0);
    for_cells(cell_of(p_mm), [&](const Cell& cell) {
      const auto found = cells_.find(cell);
      if (found == cells_.end()) return;
      for (const std::uint32_t i : found->second)
        if (glm::distance(middles_mm_[i], p_mm) <= within_mm && counts(areas_mm2_[i])) sum += areas_mm2_[i];
    });
    return sum;
  }

 private:
  using Cell = std::array<double, 3>;

  Cell cell_of(const glm::dvec3& p_mm) const {
    const glm::dvec3 at = glm::floor(p_mm / edge_mm_);
    return {at.x, at.y, at.z};
  }
  template <typename Visit>
  static void for_cells(const Cell& middle, const Visit& visit) {
    for (double x = -1.0; x <= 1.0; ++x)
      for (double y = -1.0; y <= 1.0; ++y)
        for (double z = -1.0; z <= 1.0; ++z) visit(Cell{middle[0] + x, middle[1] + y, middle[2] + z});
  }
  bool touches(const TrianglePoints& triangle, const std::set<Cell>& wanted) const {
    const auto& [a, b, c] = triangle;
    const Cell low = cell_of(glm::min(glm::min(a, b), c)), high = cell_of(glm::max(glm::max(a, b), c));
    // The box of a large triangle has more cells than are wanted.
    const double count = (high[0] - low[0] + 1.0) * (high[1] - low[1] + 1.0) * (high[2] - low[2] + 1.0);
    if (count > static_cast<double>(wanted.size()))
      return std::any_of(wanted.begin(), wanted.end(), [&](const Cell& cell) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          if (cell[axis] < low[axis] || cell[axis] > high[axis]) return false;
        return true;
      });
    for (double x = low[0]; x <= high[0]; ++x)
      for (double y = low[1]; y <= high[1]; ++y)
        for (double z = low[2]; z <= high[2]; ++z)
          if (wanted.count({x, y, z}) > 0) return true;
    return false;
  }
  /// Halves the longest side until no side is longer than a quarter of the distance.
  void split(const TrianglePoints& triangle, const std::set<Cell>& wanted) {
    int longest = 0;
    double length = 0.0;
    for (int i = 0; i < 3; ++i)
      if (const double side = glm::distance(triangle[i], triangle[(i + 1) % 3]); side > length) {
        longest = i;
        length = side;
      }
    if (length > 0.25 * edge_mm_) {
      if (length > edge_mm_ && !touches(triangle, wanted)) return;
      const glm::dvec3 a = triangle[longest], b = triangle[(longest + 1) % 3],
                       c = triangle[(longest + 2) % 3], half = 0.5 * (a + b);
      split({a, half, c}, wanted);
      split({half, b, c}, wanted);
      return;
    }
    const glm::dvec3 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    const Cell cell = cell_of(middle);
    if (wanted.count(cell) == 0) return;
    cells_[cell].push_back(static_cast<std::uint32_t>(middles_mm_.size()));
    middles_mm_.push_back(middle);
    areas_mm2_.push_back(0.5 * across(triangle));
  }

  double edge_mm_;
  std::map<Cell, std::vector<std::uint32_t>> cells_;
  std::vector<glm::dvec3> middles_mm_, areas_mm2_;
};

glm::dvec3 direction_or(const glm::dvec3& sum, const glm::dvec3& otherwise) {
  const double length = glm::length(sum);
  return length > 0.0 ? sum / length : otherwise;
}

/// Each contact's normal becomes the mean over the surface within the distance that faces the same way: as the
/// mean within half of the distance or, beside a sharp edge, as the contact's own triangle.
void smooth_normals(std::vector<DockingContact>& contacts, const Triangles& surface, double within_mm) {
  if (!(within_mm > 0.0)) return;
  const SurfacePieces pieces(surface, contacts, within_mm);
  tbb::parallel_for(std::size_t{0}, contacts.size(), [&](std::size_t i) {
    DockingContact& contact = contacts[i];
    const glm::dvec3 about =
        direction_or(pieces.area_about(contact.p_mm, 0.5 * within_mm, [](const glm::dvec3&) { return true; }),
                     contact.normal);
    const glm::dvec3 first = glm::dot(about, contact.normal) > least_alike ? about : contact.normal;
    const auto is_alike = [&](const glm::dvec3& area) {
      return glm::dot(area, first) > least_alike * glm::length(area);
    };
    contact.normal = direction_or(pieces.area_about(contact.p_mm, within_mm, is_alike), first);
  });
}

}  // namespace

std::vector<DockingContact> docking_contacts(const Solid& part, const std::vector<Solid>& objects,
                                             const DockingContactsOptions& options) {
  if (!(options.within_mm > 0.0)) throw InvalidInput("the largest gap of a contact must be above 0 mm");
  if (!(options.spacing_mm > 0.0)) throw InvalidInput("the spacing of contacts must be above 0 mm");
  if (!(options.smooth_mm >= 0.0)) throw InvalidInput("normals cannot be smoothed over less than 0 mm");
  if (part.empty() || objects.empty()) throw InvalidInput("contacts need a part and an object");
  const glm::dvec3 margin(options.within_mm + 2.0 * options.smooth_mm);
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
  smooth_normals(contacts, near, options.smooth_mm);
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
