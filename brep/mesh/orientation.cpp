// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/orientation.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <cassert>
#include <cmath>

namespace octotomy::brep {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_3 exact(const glm::dvec3& p) {
  return {p.x, p.y, p.z};
}
Kernel::Point_2 exact(const glm::dvec2& p) {
  return {p.x, p.y};
}

}  // namespace

int orientation(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& p) {
  assert(std::isfinite(glm::dot(a + b + c + p, glm::dvec3(1.0))));
  return CGAL::orientation(exact(a), exact(b), exact(c), exact(p));
}

int orientation(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
  assert(std::isfinite(glm::dot(a + b + p, glm::dvec2(1.0))));
  return CGAL::orientation(exact(a), exact(b), exact(p));
}

}  // namespace octotomy::brep
