// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/mesh/triangle_cluster.h"

#include <algorithm>

namespace octotomy::brep {

TriangleCluster cluster_of(std::span<const std::array<glm::dvec3, 3>> triangles) {
  TriangleCluster made;
  glm::dvec3 middle_sum(0.0), plain_sum(0.0);
  for (const auto& t : triangles) {
    const glm::dvec3 area = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]), middle = (t[0] + t[1] + t[2]) / 3.0;
    made.area_mm2 += glm::length(area);
    middle_sum += glm::length(area) * middle;
    plain_sum += middle;
    made.normal += area;
  }
  made.centre_mm =
      made.area_mm2 > 0.0 ? middle_sum / made.area_mm2 : plain_sum / static_cast<double>(triangles.size());
  for (const auto& t : triangles) {
    const glm::dvec3 area = 0.5 * glm::cross(t[1] - t[0], t[2] - t[0]), middle = (t[0] + t[1] + t[2]) / 3.0;
    made.moment += glm::outerProduct(area, middle - made.centre_mm);
    for (const glm::dvec3& p : t) made.radius_mm = std::max(made.radius_mm, glm::distance(p, made.centre_mm));
  }
  return made;
}

TriangleCluster cluster_of(const TriangleCluster& a, const TriangleCluster& b) {
  TriangleCluster made;
  made.area_mm2 = a.area_mm2 + b.area_mm2;
  made.normal = a.normal + b.normal;
  made.centre_mm = made.area_mm2 > 0.0 ? (a.area_mm2 * a.centre_mm + b.area_mm2 * b.centre_mm) / made.area_mm2
                                       : 0.5 * (a.centre_mm + b.centre_mm);
  for (const TriangleCluster* half : {&a, &b}) {
    made.moment += half->moment + glm::outerProduct(half->normal, half->centre_mm - made.centre_mm);
    made.radius_mm =
        std::max(made.radius_mm, half->radius_mm + glm::distance(half->centre_mm, made.centre_mm));
  }
  return made;
}

}  // namespace octotomy::brep
