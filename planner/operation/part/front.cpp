// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/operation/part/front.h"

#include <algorithm>
#include <cmath>

namespace octotomy::planner {

Front::Front(const brep::Solid& bone, const ArchFrame& frame, const glm::dvec2& low, const glm::dvec2& high)
    : lps_from_turned_(frame.look, frame.right, frame.up) {
  const brep::Triangles& whole = bone.triangles();
  const glm::dmat3 turned_from_lps = glm::transpose(lps_from_turned_);
  std::vector<std::uint32_t> number(whole.points_mm.size(), 0);
  std::vector<glm::dvec3> turned(whole.points_mm.size());
  for (std::size_t i = 0; i < turned.size(); ++i) turned[i] = turned_from_lps * whole.points_mm[i];
  for (std::uint32_t f = 0; f < whole.faces.size(); ++f) {
    const auto& face = whole.faces[f];
    const glm::dvec3 &a = turned[face[0]], &b = turned[face[1]], &c = turned[face[2]];
    const glm::dvec3 least = glm::min(a, glm::min(b, c)), most = glm::max(a, glm::max(b, c));
    if (most.y < low.x || least.y > high.x || most.z < low.y || least.z > high.y) continue;
    foremost_mm_ = std::min(foremost_mm_.value_or(least.x), least.x);
    auto& kept = turned_.faces.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& of = number[face[k]];
      if (of == 0) {
        turned_.points_mm.push_back(turned[face[k]]);
        of = static_cast<std::uint32_t>(turned_.points_mm.size());
      }
      kept[k] = of - 1;
    }
    face_of_.push_back(f);
  }
  if (!turned_.faces.empty()) tree_ = std::make_shared<const brep::SurfaceTree>(turned_);
}

std::optional<Seen> Front::first(const glm::dvec2& p_mm) const {
  if (tree_ == nullptr) return std::nullopt;
  std::optional<Seen> seen;
  for (const brep::Crossing& crossing : tree_->crossings({*foremost_mm_ - 1.0, p_mm.x, p_mm.y})) {
    const auto& face = turned_.faces[crossing.face];
    const glm::dvec3 &a = turned_.points_mm[face[0]], &b = turned_.points_mm[face[1]],
                     &c = turned_.points_mm[face[2]];
    // The axes look, right and up form a left-handed system.
    const glm::dvec3 normal = -glm::cross(b - a, c - a);
    if (normal.x == 0.0) continue;
    const double depth_mm = a.x - (normal.y * (p_mm.x - a.y) + normal.z * (p_mm.y - a.z)) / normal.x;
    if (!seen || depth_mm < seen->depth_mm)
      seen = Seen{depth_mm, lps_from_turned_ * glm::normalize(normal), face_of_[crossing.face]};
  }
  return seen;
}

}  // namespace octotomy::planner
