// SPDX-License-Identifier: AGPL-3.0-or-later
// A ray crosses a triangle if an odd number of its edges, projected along x, pass the point on one side. Each
// edge is evaluated from its lower end, whichever triangle it belongs to, so neighbours agree and no ray
// slips between them.
#include "brep/mesh/ray_passing.h"

#include "brep/mesh/orientation.h"

namespace octotomy::brep {
namespace {

/// Projects along x, the direction of the ray.
glm::dvec2 projected(const glm::dvec3& p) {
  return {p.y, p.z};
}

/// Whether the projected edge straddles the point's z (by the half-open rule) and passes the point on the
/// side of larger y. Exact, because one wrong crossing would invert a whole part of a solid.
bool edge_passes(const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& to) {
  if ((from.z <= p.z) == (to.z <= p.z)) return false;
  if (from.y <= p.y && to.y <= p.y) return false;
  if (from.y > p.y && to.y > p.y) return true;
  const glm::dvec3 &low = from.z < to.z ? from : to, &high = from.z < to.z ? to : from;
  return orientation(projected(low), projected(high), projected(p)) > 0;
}

bool passes(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const bool in_projection =
      edge_passes(p, a, b) != edge_passes(p, b, c) ? !edge_passes(p, c, a) : edge_passes(p, c, a);
  if (!in_projection) return false;
  if (a.x <= p.x && b.x <= p.x && c.x <= p.x) return false;
  if (a.x > p.x && b.x > p.x && c.x > p.x) return true;
  // The plane lies ahead along +x if the sign of the normal's x differs from the side of the point.
  const int normal_x = orientation(projected(a), projected(b), projected(c));
  return orientation(a, b, c, p) * normal_x < 0;
}

}  // namespace

RayPassing passing_of(const glm::dvec3& from, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  if (!passes(from, a, b, c)) return RayPassing::Beside;
  return glm::cross(b - a, c - a).x > 0.0 ? RayPassing::Leaving : RayPassing::Entering;
}

}  // namespace octotomy::brep
