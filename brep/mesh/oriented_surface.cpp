// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/oriented_surface.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "brep/mesh/distance.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

glm::dvec3 unit(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : glm::dvec3(0.0);
}

/// The angle between two sides. For small angles atan2 is accurate and acos is not.
double angle_between(const glm::dvec3& u, const glm::dvec3& v) {
  return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

}  // namespace

struct OrientedSurface::Surface {
  /// Normals of a triangle, its sides and its corners; side k runs from corner k to the next.
  struct Face {
    glm::dvec3 normal{0.0};
    std::array<std::uint32_t, 3> corners{}, across{};
  };
  static constexpr std::uint32_t nothing = ~std::uint32_t{0};

  SurfaceTree tree;
  std::vector<Face> faces;
  std::vector<glm::dvec3> corner_normals;
  std::vector<std::uint8_t> corner_on_border;

  explicit Surface(const Linked& linked)
      : tree(linked.triangles),
        faces(linked.triangles.faces.size()),
        corner_normals(linked.triangles.points_mm.size(), glm::dvec3(0.0)),
        corner_on_border(linked.triangles.points_mm.size(), 0) {
    const Triangles& triangles = linked.triangles;
    std::vector<std::array<double, 3>> angles(faces.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces.size(), 1024), [&](const auto& range) {
      for (std::size_t f = range.begin(); f != range.end(); ++f) {
        Face& face = faces[f];
        face.corners = triangles.faces[f];
        std::array<glm::dvec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = triangles.points_mm[face.corners[k]];
        face.normal = unit(glm::cross(p[1] - p[0], p[2] - p[0]));
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t beyond = linked.opposite[3 * f + k];
          face.across[k] = beyond != Linked::none ? beyond / 3 : nothing;
          angles[f][k] = angle_between(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
        }
      }
    });
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        const Face& face = faces[f];
        corner_normals[face.corners[k]] += angles[f][k] * face.normal;
        if (face.across[k] == nothing)
          corner_on_border[face.corners[k]] = corner_on_border[face.corners[(k + 1) % 3]] = 1;
      }
    for (glm::dvec3& normal : corner_normals) normal = unit(normal);
  }

  SignedFoot signed_foot(const glm::dvec3& p_mm, const Foot& foot) const {
    assert(foot.face < faces.size());
    const Face& face = faces[foot.face];
    SignedFoot answer{foot.p_mm, face.normal, foot.distance_mm, false};
    std::size_t zeros = 0, zero = 0, full = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (foot.weights[static_cast<int>(k)] == 0.0) {
        ++zeros;
        zero = k;
      } else {
        full = k;
      }
    }
    assert(zeros < 3);
    if (zeros == 2) {
      answer.normal = corner_normals[face.corners[full]];
      answer.on_border = corner_on_border[face.corners[full]] != 0;
    } else if (zeros == 1) {
      const std::uint32_t beyond = face.across[(zero + 1) % 3];
      answer.on_border = beyond == nothing;
      if (beyond != nothing) answer.normal = unit(face.normal + faces[beyond].normal);
    }
    if (glm::dot(p_mm - foot.p_mm, answer.normal) < 0.0) answer.distance_mm = -answer.distance_mm;
    return answer;
  }
};

OrientedSurface::OrientedSurface(const Mesh& mesh) : OrientedSurface(linked_of(mesh)) {}
OrientedSurface::OrientedSurface(const Linked& linked) : surface_(std::make_unique<Surface>(linked)) {}
OrientedSurface::~OrientedSurface() = default;
OrientedSurface::OrientedSurface(OrientedSurface&&) noexcept = default;
OrientedSurface& OrientedSurface::operator=(OrientedSurface&&) noexcept = default;

std::vector<SignedFoot> OrientedSurface::feet(const std::vector<glm::dvec3>& points_mm) const {
  std::vector<SignedFoot> feet(points_mm.size());
  surface_->tree.visit_feet(points_mm, [&](std::size_t i, const Foot& foot) {
    feet[i] = surface_->signed_foot(points_mm[i], foot);
  });
  return feet;
}

std::vector<OrientedSurface::Distance> OrientedSurface::distances(
    const std::vector<glm::dvec3>& points_mm) const {
  std::vector<Distance> distances(points_mm.size());
  surface_->tree.visit_feet(points_mm, [&](std::size_t i, const Foot& foot) {
    const SignedFoot found = surface_->signed_foot(points_mm[i], foot);
    distances[i] = {found.distance_mm, found.on_border};
  });
  return distances;
}

}  // namespace octotomy::brep
