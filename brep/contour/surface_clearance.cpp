// SPDX-License-Identifier: AGPL-3.0-or-later
#include "brep/contour/surface_clearance.h"

#include <algorithm>
#include <utility>

namespace octotomy::brep {
namespace {

/// Six times the signed volume of a tetrahedron.
double volume_of(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  return glm::dot(glm::cross(b - a, c - a), d - a);
}

bool crosses(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& a, const glm::dvec3& b,
             const glm::dvec3& c) {
  if ((volume_of(a, b, c, from) > 0.0) == (volume_of(a, b, c, to) > 0.0)) return false;
  const bool left = volume_of(from, to, a, b) > 0.0;
  return left == (volume_of(from, to, b, c) > 0.0) && left == (volume_of(from, to, c, a) > 0.0);
}

/// Whether a segment may meet a box.
class MayMeet {
 public:
  MayMeet(const glm::dvec3& from, const glm::dvec3& to) : from_(from), way_(to - from) {}

  bool operator()(const OuterBox& box) const {
    double enters = 0.0, leaves = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (way_[axis] == 0.0) {
        if (from_[axis] < box.low[axis] || from_[axis] > box.high[axis]) return false;
        continue;
      }
      const double low = (box.low[axis] - from_[axis]) / way_[axis];
      const double high = (box.high[axis] - from_[axis]) / way_[axis];
      enters = std::max(enters, std::min(low, high));
      leaves = std::min(leaves, std::max(low, high));
    }
    return enters <= leaves;
  }

 private:
  glm::dvec3 from_, way_;
};

}  // namespace

SurfaceClearance::SurfaceClearance(Triangles surface) : surface_(std::move(surface)), tree_(surface_) {}

int SurfaceClearance::crossed(const glm::dvec3& from_mm, const glm::dvec3& to_mm, int most) const {
  int count = 0;
  const MayMeet may_meet(from_mm, to_mm);
  tree_.visit([&](const OuterBox& box) { return count < most && may_meet(box); },
              [&](std::uint32_t face) {
                const auto& [a, b, c] = surface_.faces[face];
                const auto& points = surface_.points_mm;
                count += crosses(from_mm, to_mm, points[a], points[b], points[c]) ? 1 : 0;
              });
  return std::min(count, most);
}

}  // namespace octotomy::brep
