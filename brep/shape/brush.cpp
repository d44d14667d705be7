// SPDX-License-Identifier: AGPL-3.0-or-later
// 1. The polyhedron's corners are those intersections of three of its planes that lie beyond no other plane.
// 2. A face's corners are put into order by their angle about the face's normal.
// 3. Along a segment, faces that look forward are moved to its end, and the others to its start. Each edge
//    between the two kinds makes a parallelogram. Every corner is a corner of the polyhedron at one of the ends,
//    so that consecutive hulls have the same triangles at the point that they share.
// 4. The hulls are united in pairs.
#include "brep/shape/brush.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

struct Plane {
  glm::dvec3 normal{0.0, 0.0, 1.0};
  double distance_mm = 1.0;  ///< from the origin
};

/// A convex polyhedron about the origin.
struct Polyhedron {
  std::vector<glm::dvec3> corners_mm;
  std::vector<glm::dvec3> normals;                ///< of its faces
  std::vector<std::vector<std::uint32_t>> faces;  ///< corners, counter-clockwise from outside
};

Polyhedron polyhedron_of(const std::vector<Plane>& planes) {
  Polyhedron made;
  std::vector<std::array<std::size_t, 3>> met;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const Plane &a = planes[i], &b = planes[j], &c = planes[k];
        const glm::dvec3 bc = glm::cross(b.normal, c.normal);
        const double volume = glm::dot(a.normal, bc);
        // The smallest triple product of the normals of faces that share a corner is 0.38, of a prism's sides
        // and cap.
        if (!(std::abs(volume) > 0.1)) continue;
        const glm::dvec3 corner_mm = (a.distance_mm * bc + b.distance_mm * glm::cross(c.normal, a.normal) +
                                      c.distance_mm * glm::cross(a.normal, b.normal)) /
                                     volume;
        // A plane that does not meet at a corner passes the corner at a hundredth or more of the corner's
        // distance from the origin. Rounding is far below that.
        const double slack_mm = 1e-9 * glm::length(corner_mm);
        if (std::all_of(planes.begin(), planes.end(), [&](const Plane& plane) {
              return glm::dot(plane.normal, corner_mm) <= plane.distance_mm + slack_mm;
            })) {
          made.corners_mm.push_back(corner_mm);
          met.push_back({i, j, k});
        }
      }
  for (std::size_t f = 0; f < planes.size(); ++f) {
    made.normals.push_back(planes[f].normal);
    std::vector<std::uint32_t> ring;
    glm::dvec3 middle_mm(0.0);
    for (std::uint32_t c = 0; c < met.size(); ++c)
      if (std::find(met[c].begin(), met[c].end(), f) != met[c].end()) {
        ring.push_back(c);
        middle_mm += made.corners_mm[c];
      }
    middle_mm /= static_cast<double>(ring.size());
    const glm::dvec3 right = glm::normalize(made.corners_mm[ring.front()] - middle_mm);
    const glm::dvec3 up = glm::cross(planes[f].normal, right);
    const auto angle = [&](std::uint32_t c) {
      const glm::dvec3 arm = made.corners_mm[c] - middle_mm;
      return std::atan2(glm::dot(arm, up), glm::dot(arm, right));
    };
    std::sort(ring.begin(), ring.end(),
              [&](std::uint32_t a, std::uint32_t b) { return angle(a) < angle(b); });
    made.faces.push_back(std::move(ring));
  }
  return made;
}

/// Distances of faces from the centre, in radii, at which the polyhedra have the volumes of the ball and the
/// disc.
constexpr double ball_plane = 0.9675583399663303;
constexpr double disc_plane = 0.993537015401427;

/// The planes lie in the directions of the 12 corners of an icosahedron and of the 20 of its dual.
std::vector<Plane> ball_planes(double radius_mm) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  const std::array<glm::dvec3, 3> octant{glm::dvec3(0.0, 1.0, g), glm::dvec3(0.0, g, g - 1.0),
                                         glm::dvec3(1.0, 1.0, 1.0)};
  std::vector<Plane> planes;
  for (int signs = 0; signs < 8; ++signs)
    for (int turn = 0; turn < 3; ++turn)
      for (const glm::dvec3& direction : octant) {
        const bool is_diagonal = direction.x != 0.0;
        // Lists each direction once: exchanging the axes does not change a diagonal, and the sign of a
        // component of 0 has no effect.
        if (is_diagonal ? turn > 0 : (signs & 1) != 0) continue;
        const glm::dvec3 signed_direction((signs & 1) != 0 ? -direction.x : direction.x,
                                          (signs & 2) != 0 ? -direction.y : direction.y,
                                          (signs & 4) != 0 ? -direction.z : direction.z);
        glm::dvec3 turned;
        for (int axis = 0; axis < 3; ++axis) turned[(axis + turn) % 3] = signed_direction[axis];
        planes.push_back({turned / glm::length(turned), ball_plane * radius_mm});
      }
  return planes;
}

std::vector<Plane> disc_planes(const BrushTrace::Disc& disc, double radius_mm) {
  constexpr int sides = 16;
  std::vector<Plane> planes{{disc.normal, 0.5 * disc.thickness_mm}, {-disc.normal, 0.5 * disc.thickness_mm}};
  const glm::dvec3 other = glm::cross(disc.normal, disc.across);
  for (int side = 0; side < sides; ++side) {
    const double turn = std::numbers::pi * (2 * side + 1) / sides;
    planes.push_back({disc.across * std::cos(turn) + other * std::sin(turn), disc_plane * radius_mm});
  }
  return planes;
}

/// The hull of the polyhedron at both ends of a line; the ends may be one point.
Solid hull_of(const Polyhedron& polyhedron, const glm::dvec3& start_mm, const glm::dvec3& end_mm) {
  Triangles hull;
  std::map<std::pair<std::uint32_t, bool>, std::uint32_t> numbers;
  const auto corner = [&](std::uint32_t c, bool at_end) {
    const auto [found, is_new] =
        numbers.emplace(std::pair(c, at_end), static_cast<std::uint32_t>(hull.points_mm.size()));
    if (is_new) hull.points_mm.push_back((at_end ? end_mm : start_mm) + polyhedron.corners_mm[c]);
    return found->second;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> looks_forward;  // by edge: whether the face on its
                                                                          // left faces the line's end
  for (std::size_t f = 0; f < polyhedron.faces.size(); ++f) {
    const std::vector<std::uint32_t>& ring = polyhedron.faces[f];
    const bool forward = glm::dot(polyhedron.normals[f], end_mm - start_mm) > 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i)
      looks_forward[{ring[i], ring[(i + 1) % ring.size()]}] = forward;
    for (std::size_t i = 2; i < ring.size(); ++i)
      hull.faces.push_back(
          {corner(ring[0], forward), corner(ring[i - 1], forward), corner(ring[i], forward)});
  }
  for (const auto& [edge, forward] : looks_forward) {
    const auto [from, to] = edge;
    if (!forward || looks_forward.at({to, from})) continue;
    hull.faces.push_back({corner(from, false), corner(to, false), corner(to, true)});
    hull.faces.push_back({corner(from, false), corner(to, true), corner(from, true)});
  }
  return solid_of(hull);
}

void check(const BrushTrace& trace) {
  const auto is_length = [](double mm) { return std::isfinite(mm) && mm > 0.0; };
  if (trace.points_mm.empty()) throw InvalidInput("brush_solid: a trace has no points");
  if (!is_length(trace.radius_mm) || (trace.disc && !is_length(trace.disc->thickness_mm)))
    throw InvalidInput("brush_solid: radius and thickness must be above 0 mm and finite");
}

}  // namespace

BooleanResult brush_solid(const std::vector<BrushTrace>& traces, const std::stop_token& stop) {
  if (traces.empty()) throw InvalidInput("brush_solid: there are no traces");
  std::vector<Solid> hulls;
  for (const BrushTrace& trace : traces) {
    check(trace);
    const Polyhedron polyhedron =
        polyhedron_of(trace.disc ? disc_planes(*trace.disc, trace.radius_mm) : ball_planes(trace.radius_mm));
    const std::size_t before = hulls.size();
    for (std::size_t i = 1; i < trace.points_mm.size(); ++i)
      if (trace.points_mm[i] != trace.points_mm[i - 1])
        hulls.push_back(hull_of(polyhedron, trace.points_mm[i - 1], trace.points_mm[i]));
    if (hulls.size() == before)
      hulls.push_back(hull_of(polyhedron, trace.points_mm.front(), trace.points_mm.front()));
  }
  if (hulls.size() == 1) return {hulls.front(), {}, 0.0, {}};
  return boolean(hulls, Operation::Union, stop);
}

}  // namespace octotomy::brep
