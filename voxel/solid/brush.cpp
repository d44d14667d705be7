// SPDX-License-Identifier: AGPL-3.0-or-later
// The convex hull of a convex polyhedron placed at both ends of a segment is the Minkowski sum of the two.
// Its faces are the polyhedron's faces, each at the end that lies further along the face's normal, and one
// face for each edge of the silhouette along the segment. A silhouette face's normal and offset are the same
// positive combination of its edge's two faces' normals and offsets, so no corner has to be computed.
#include "voxel/solid/brush.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "voxel/space/error.h"

namespace octotomy::voxel {
namespace {

/// A convex polyhedron around the origin, the shape of the brush.
struct Dab {
  std::vector<HalfSpace> faces;
  std::vector<std::array<std::size_t, 2>> edges;  ///< pairs of faces that share an edge
};

/// Distance of the polyhedron's faces from its centre, in radii of the ball, so that it has the ball's
/// volume.
constexpr double ball_face = 0.9675583399663303;
/// Distance of the prism's 16 sides from its axis, in radii of the disc, so that they enclose the disc's
/// area.
constexpr double slab_side = 0.993537015401427;
constexpr std::size_t slab_sides = 16;

/// A truncated icosahedron: pentagons in the directions of an icosahedron's corners, hexagons in those of its
/// faces. No face is normal to an axis.
Dab ball(double radius_mm) {
  constexpr double golden = std::numbers::phi;
  std::vector<glm::dvec3> normals;
  const auto add_turned = [&](double y, double z) {
    for (const double v : {y, -y})
      for (const double w : {z, -z})
        normals.insert(normals.end(), {glm::dvec3(0.0, v, w), glm::dvec3(w, 0.0, v), glm::dvec3(v, w, 0.0)});
  };
  add_turned(1.0, golden);
  add_turned(golden, 1.0 / golden);
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0})
      for (const double z : {1.0, -1.0}) normals.emplace_back(x, y, z);
  Dab dab;
  for (const glm::dvec3& normal : normals)
    dab.faces.push_back({glm::normalize(normal), ball_face * radius_mm});
  // The cosine between two normals is 0.745 or 0.795 for faces that share an edge, and at most 0.45 for
  // others.
  constexpr double between = 0.6;
  for (std::size_t i = 0; i < normals.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (glm::dot(dab.faces[i].normal, dab.faces[j].normal) > between) dab.edges.push_back({j, i});
  return dab;
}

Dab prism(const BrushStroke::Slab& slab, double radius_mm) {
  const glm::dvec3 third = glm::cross(slab.normal, slab.across);
  Dab dab;
  for (std::size_t i = 0; i < slab_sides; ++i) {
    const double angle = (static_cast<double>(i) + 0.5) * 2.0 * std::numbers::pi / slab_sides;
    dab.faces.push_back(
        {glm::normalize(std::cos(angle) * slab.across + std::sin(angle) * third), slab_side * radius_mm});
    dab.edges.push_back({i, (i + 1) % slab_sides});
    for (const std::size_t cap : {slab_sides, slab_sides + 1}) dab.edges.push_back({i, cap});
  }
  dab.faces.push_back({slab.normal, 0.5 * slab.thickness_mm});
  dab.faces.push_back({-slab.normal, 0.5 * slab.thickness_mm});
  return dab;
}

/// Joins the parts in pairs, so that the expression's depth is the logarithm of the number of parts.
template <typename Join>
Expression joined(std::vector<Expression> parts, const Join& join) {
  while (parts.size() > 1) {
    std::vector<Expression> next;
    for (std::size_t i = 0; i + 1 < parts.size(); i += 2) next.push_back(join(parts[i], parts[i + 1]));
    if (parts.size() % 2 != 0) next.push_back(parts.back());
    parts = std::move(next);
  }
  return parts.front();
}

/// The convex hull of the brush's polyhedra at both points, which may coincide.
Expression swept(const Dab& dab, const glm::dvec3& from_mm, const glm::dvec3& to_mm) {
  // A cosine below this is a rounding error: the face is parallel to the segment.
  constexpr double parallel = 64.0 * std::numeric_limits<double>::epsilon();
  const double length_mm = glm::distance(from_mm, to_mm);
  const glm::dvec3 along = length_mm > 0.0 ? (to_mm - from_mm) / length_mm : glm::dvec3(0.0);
  std::vector<Expression> sides;
  for (const HalfSpace& face : dab.faces)
    sides.emplace_back(HalfSpace{face.normal, face.offset_mm + std::max(glm::dot(face.normal, from_mm),
                                                                        glm::dot(face.normal, to_mm))});
  for (const auto& [i, j] : dab.edges) {
    const HalfSpace &a = dab.faces[i], &b = dab.faces[j];
    const double of_a = glm::dot(a.normal, along), of_b = glm::dot(b.normal, along);
    if (!(std::min(of_a, of_b) < -parallel && std::max(of_a, of_b) > parallel)) continue;
    const glm::dvec3 sum = std::abs(of_b) * a.normal + std::abs(of_a) * b.normal;
    const double length = glm::length(sum);
    const glm::dvec3 normal = sum / length;
    const double offset_mm = (std::abs(of_b) * a.offset_mm + std::abs(of_a) * b.offset_mm) / length;
    sides.emplace_back(HalfSpace{normal, offset_mm + glm::dot(normal, from_mm)});
  }
  return joined(std::move(sides), [](const Expression& a, const Expression& b) { return a & b; });
}

void check(const BrushStroke& stroke) {
  const auto positive = [](double mm) { return mm > 0.0 && std::isfinite(mm); };
  if (stroke.points_mm.empty())
    throw InvalidInput("a stroke of the brush has no point: draw each stroke through at least one");
  if (!positive(stroke.radius_mm) || (stroke.slab && !positive(stroke.slab->thickness_mm)))
    throw InvalidInput("the brush's radius and thickness must be positive");
}

}  // namespace

Expression brush(const std::vector<BrushStroke>& strokes) {
  if (strokes.empty()) throw InvalidInput("the brush has no stroke: draw at least one");
  std::vector<Expression> parts;
  for (const BrushStroke& stroke : strokes) {
    check(stroke);
    const Dab dab = stroke.slab ? prism(*stroke.slab, stroke.radius_mm) : ball(stroke.radius_mm);
    std::vector<glm::dvec3> line;
    for (const glm::dvec3& p_mm : stroke.points_mm)
      if (line.empty() || p_mm != line.back()) line.push_back(p_mm);
    if (line.size() == 1) parts.push_back(swept(dab, line[0], line[0]));
    for (std::size_t i = 1; i < line.size(); ++i) parts.push_back(swept(dab, line[i - 1], line[i]));
  }
  return joined(std::move(parts), [](const Expression& a, const Expression& b) { return a | b; });
}

}  // namespace octotomy::voxel
