// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/deform.h"

#include <cmath>

#include "brep/mesh/error.h"
#include "brep/mesh/triangles.h"

namespace octotomy::brep {
namespace {

void check_affine(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) throw InvalidInput("deformed: an entry of the map is not finite");
  for (int column = 0; column < 4; ++column)
    if (m[column][3] != (column == 3 ? 1.0 : 0.0))
      throw InvalidInput("deformed: the last row of the map is not 0 0 0 1");
  const double volume = glm::dot(glm::dvec3(m[0]), glm::cross(glm::dvec3(m[1]), glm::dvec3(m[2])));
  if (!(volume > 0.0))
    throw InvalidInput(volume < 0.0 ? "deformed: the map mirrors; mirror the surface about a plane instead"
                                    : "deformed: the map is singular: it flattens the surface");
}

Triangles deformed_triangles(Triangles triangles, const glm::dmat4& m) {
  check_affine(m);
  for (glm::dvec3& p : triangles.points_mm) {
    const glm::dvec3 q(m[0][0] * p.x + m[1][0] * p.y + m[2][0] * p.z + m[3][0],
                       m[0][1] * p.x + m[1][1] * p.y + m[2][1] * p.z + m[3][1],
                       m[0][2] * p.x + m[1][2] * p.y + m[2][2] * p.z + m[3][2]);
    if (!std::isfinite(q.x + q.y + q.z)) throw InvalidInput("deformed: a point leaves the range of numbers");
    p = q;
  }
  return triangles;
}

}  // namespace

Mesh deformed(const Mesh& mesh, const glm::dmat4& deformed_from_still) {
  return mesh_of(deformed_triangles(triangles_of(mesh), deformed_from_still));
}

Solid deformed(const Solid& solid, const glm::dmat4& deformed_from_still) {
  return trusted_solid(deformed_triangles(solid.triangles(), deformed_from_still),
                       proof_of_image(solid.proof()));
}

}  // namespace octotomy::brep
