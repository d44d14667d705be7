// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/move.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "brep/mesh/error.h"
#include "brep/mesh/mesh_point.h"
#include "brep/mesh/solid.h"

namespace octotomy::brep {
namespace {

/// Why a matrix is no affine map: an entry that is not finite, or another last row. Null if it is one.
const char* why_not_affine(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(m[column][row])) return "an entry is not finite";
  for (int column = 0; column < 4; ++column)
    if (m[column][3] != (column == 3 ? 1.0 : 0.0)) return "its last row is not 0 0 0 1";
  return nullptr;
}

/// Tolerance of orthonormality, for the products of the columns. In a matrix printed with ten digits each
/// product errs by less than 2e-10. With an error t, a moved volume changes by less than the share 3 t, far
/// below the resolution of voxels.
constexpr double rigid_tolerance() {
  return 1e-9;
}

void check_rigid(const glm::dmat4& m) {
  const auto refuse = [](const std::string& why) {
    throw InvalidInput("the motion is not rigid: " + why +
                       "; give a rotation without scale or mirror, then a translation");
  };
  if (const char* why = why_not_affine(m)) refuse(why);
  const glm::dmat3 r(m);
  const glm::dmat3 products = glm::transpose(r) * r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const double off = std::abs(products[i][j] - (i == j ? 1.0 : 0.0));
      if (off > rigid_tolerance())
        refuse("columns " + std::to_string(i) + " and " + std::to_string(j) + " are off orthonormal by " +
               std::to_string(off));
    }
  if (glm::determinant(r) < 0.0) refuse("it mirrors");
}

/// A rigid motion that was checked.
class Motion {
 public:
  explicit Motion(const glm::dmat4& moved_from_still)
      : rotation_(moved_from_still), translation_(moved_from_still[3]) {
    check_rigid(moved_from_still);
  }
  glm::dvec3 operator()(const glm::dvec3& p_mm) const { return rotation_ * p_mm + translation_; }

 private:
  glm::dmat3 rotation_;
  glm::dvec3 translation_;
};

}  // namespace

Mesh moved(const Mesh& mesh, const glm::dmat4& moved_from_still) {
  const Motion motion(moved_from_still);
  Mesh result = mesh;
  for (const auto v : result.all_vertices()) {
    const glm::dvec3 q = motion(glm_of(mesh.point(v)));
    result.set_point(v, Mesh::Point(q.x, q.y, q.z));
  }
  return result;
}

Triangles moved(const Triangles& triangles, const glm::dmat4& moved_from_still) {
  const Motion motion(moved_from_still);
  Triangles result = triangles;
  for (glm::dvec3& p : result.points_mm) p = motion(p);
  return result;
}

Solid deformed(const Solid& solid, const glm::dmat4& deformed_from_still) {
  const glm::dmat4& m = deformed_from_still;
  if (const char* why = why_not_affine(m))
    throw InvalidInput(std::string("deformed: the map is not affine: ") + why);
  const double volume = glm::determinant(glm::dmat3(m));
  if (!(volume > 0.0))
    throw InvalidInput(volume < 0.0 ? "deformed: the map mirrors; mirror the surface about a plane instead"
                                    : "deformed: the map is singular: it flattens the surface");
  Triangles triangles = solid.triangles();
  for (glm::dvec3& p : triangles.points_mm) {
    p = glm::dvec3(m * glm::dvec4(p, 1.0));
    if (!std::isfinite(p.x + p.y + p.z))
      throw InvalidInput("deformed: a coordinate leaves the range of doubles");
  }
  return trusted_solid(std::move(triangles), proof_of_image(solid.proof()));
}

}  // namespace octotomy::brep
