// SPDX-License-Identifier: AGPL-3.0-or-later
// A triangle is passed where an odd number of its edges, projected along x, run past the point on one side;
// each edge is judged from its lower end whichever triangle asks, so neighbours agree and no ray slips
// between them.
#include "brep/mesh/ray_passing.h"

#include "brep/mesh/orientation.h"

namespace octotomy::brep {
namespace {

/// As the ray along x sees it.
glm::dvec2 projected(const glm::dvec3& p) {
  return {p.y, p.z};
}

/// Whether the projected edge, which straddles the point's z by the half-open rule, runs past its larger y.
/// Exactly, as all of passes(): one wrong crossing turns a whole part of a solid inside out.
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
  // Along +x the plane lies ahead where the point is not on the side that the normal says.
  const int normal_x = orientation(projected(a), projected(b), projected(c));
  return orientation(a, b, c, p) * normal_x < 0;
}

}  // namespace

RayPassing passing_of(const glm::dvec3& from, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  if (!passes(from, a, b, c)) return RayPassing::Beside;
  return glm::cross(b - a, c - a).x > 0.0 ? RayPassing::Leaving : RayPassing::Entering;
}

}  // namespace octotomy::brep
