// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/boolean/coplanar_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace octotomy::brep {
namespace {

bool are_on(const std::array<glm::dvec3, 3>& points_mm, const Plane& plane, double tolerance_mm) {
  return std::all_of(points_mm.begin(), points_mm.end(), [&](const glm::dvec3& p) {
    return std::abs(glm::dot(plane.normal, p - plane.on_mm)) <= tolerance_mm;
  });
}

/// The distance of a plane from an origin that all planes share, along its normal or along the reversed
/// normal.
struct Offset {
  double along_mm = 0.0;
  const Plane* plane = nullptr;
  bool is_turned = false;
};

}  // namespace

PointRounding point_rounding(const Triangles& a, const Triangles& b) {
  PointRounding rounding{true};
  for (const Triangles* surface : {&a, &b})
    for (const glm::dvec3& p : surface->points_mm)
      for (int k = 0; k < 3; ++k) {
        rounding.are_floats = rounding.are_floats && p[k] == static_cast<double>(static_cast<float>(p[k]));
        rounding.reach_mm = std::max(rounding.reach_mm, std::abs(p[k]));
      }
  rounding.mm =
      rounding.reach_mm * (rounding.are_floats ? static_cast<double>(std::numeric_limits<float>::epsilon())
                                               : std::numeric_limits<double>::epsilon());
  return rounding;
}

std::vector<Plane> planes_of(const Triangles& surface, const glm::dvec3& low, const glm::dvec3& high) {
  std::vector<Plane> planes;
  for (std::uint32_t f = 0; f < surface.faces.size(); ++f) {
    const auto& face = surface.faces[f];
    const std::array<glm::dvec3, 3> p{surface.points_mm[face[0]], surface.points_mm[face[1]],
                                      surface.points_mm[face[2]]};
    if (glm::any(glm::lessThan(glm::max(glm::max(p[0], p[1]), p[2]), low)) ||
        glm::any(glm::greaterThan(glm::min(glm::min(p[0], p[1]), p[2]), high)))
      continue;
    const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    const glm::dvec3 size = glm::abs(normal);
    const int largest = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    planes.push_back({normal / (normal[largest] < 0.0 ? -length : length), (p[0] + p[1] + p[2]) / 3.0,
                      0.5 * length, p, f});
  }
  return planes;
}

void for_each_coplanar_pair(const std::vector<Plane>& of_a, const std::vector<Plane>& of_b,
                            double tolerance_mm,
                            const std::function<void(const Plane&, const Plane&)>& visit) {
  if (of_a.empty() || of_b.empty()) return;
  const glm::dvec3 origin_mm = of_a.front().on_mm;
  double reach_mm = 0.0;
  for (const std::vector<Plane>* planes : {&of_a, &of_b})
    for (const Plane& plane : *planes) reach_mm = std::max(reach_mm, glm::distance(plane.on_mm, origin_mm));
  // Triangles on a common plane differ by at most the tolerance in position and by `same_direction` in
  // normal.
  const double range_mm = tolerance_mm + 2.0 * same_direction() * reach_mm;
  std::vector<Offset> offsets;
  for (const Plane& plane : of_b) {
    const double along_mm = glm::dot(plane.normal, plane.on_mm - origin_mm);
    // If two components of a normal are almost equally large, rounding decides the normal's sign, so both
    // signs are listed.
    offsets.push_back({along_mm, &plane, false});
    offsets.push_back({-along_mm, &plane, true});
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const Offset& p, const Offset& q) { return p.along_mm < q.along_mm; });
  for (const Plane& a : of_a) {
    const double along_mm = glm::dot(a.normal, a.on_mm - origin_mm);
    auto at = std::lower_bound(offsets.begin(), offsets.end(), along_mm - range_mm,
                               [](const Offset& p, double mm) { return p.along_mm < mm; });
    for (; at != offsets.end() && at->along_mm <= along_mm + range_mm; ++at) {
      const Plane& b = *at->plane;
      if (at->is_turned != (glm::dot(a.normal, b.normal) < 0.0) ||
          glm::length(glm::cross(a.normal, b.normal)) > same_direction())
        continue;
      const bool is_a_wider = a.area_mm2 >= b.area_mm2;
      if (are_on((is_a_wider ? b : a).corners_mm, is_a_wider ? a : b, tolerance_mm)) visit(a, b);
    }
  }
}

}  // namespace octotomy::brep
