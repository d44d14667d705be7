// SPDX-License-Identifier: AGPL-3.0-or-later
#include "verify/witness/warped_witness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "verify/witness/moved_points.h"

namespace octotomy::verify {
namespace {

/// The faces that belong to one element only. Their corners are in any order, because distances to a face do
/// not depend on the order.
brep::Triangles skin_of(const convert::Tetrahedra& elements) {
  using Face = std::array<std::uint32_t, 3>;
  std::vector<Face> faces;
  faces.reserve(4 * elements.tets.size());
  for (const auto& tet : elements.tets)
    for (std::size_t without = 0; without < 4; ++without) {
      Face face{tet[(without + 1) % 4], tet[(without + 2) % 4], tet[(without + 3) % 4]};
      std::sort(face.begin(), face.end());
      faces.push_back(face);
    }
  std::sort(faces.begin(), faces.end());
  brep::Triangles skin{elements.nodes_mm, {}};
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool is_shared =
        (i > 0 && faces[i] == faces[i - 1]) || (i + 1 < faces.size() && faces[i] == faces[i + 1]);
    if (!is_shared) skin.faces.push_back(faces[i]);
  }
  return skin;
}

/// The weights of an element's corners at a point. They add up to 1; a weight below 0 means beyond a face.
glm::dvec4 shares_of(const glm::dvec3& p, const std::array<glm::dvec3, 4>& corners) {
  const glm::dmat3 sides(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
  const glm::dvec3 shares = glm::inverse(sides) * (p - corners[0]);
  return {1.0 - shares.x - shares.y - shares.z, shares};
}

}  // namespace

NodeMotion::NodeMotion(const convert::Tetrahedra& elements, std::vector<glm::dvec3> displacement_mm,
                       double fade_mm)
    : nodes_mm_(elements.nodes_mm),
      displacement_mm_(std::move(displacement_mm)),
      fade_mm_(fade_mm),
      low_mm_(std::numeric_limits<double>::infinity()),
      high_mm_(-low_mm_),
      tets_(elements.tets) {
  if (tets_.empty()) throw std::invalid_argument("a motion of nodes needs at least one element");
  if (displacement_mm_.size() != nodes_mm_.size())
    throw std::invalid_argument("a motion of nodes needs one displacement for each node, not " +
                                std::to_string(displacement_mm_.size()) + " of " +
                                std::to_string(nodes_mm_.size()));
  for (const glm::dvec3& node_mm : nodes_mm_) {
    low_mm_ = glm::min(low_mm_, node_mm);
    high_mm_ = glm::max(high_mm_, node_mm);
  }
  std::vector<BoxGrid::Box> boxes;
  double sum_mm = 0.0;
  for (const auto& tet : tets_) {
    BoxGrid::Box box{nodes_mm_[tet[0]], nodes_mm_[tet[0]]};
    for (const std::uint32_t node : tet) {
      box.low_mm = glm::min(box.low_mm, nodes_mm_[node]);
      box.high_mm = glm::max(box.high_mm, nodes_mm_[node]);
    }
    sum_mm += glm::length(box.high_mm - box.low_mm);
    boxes.push_back(box);
  }
  cells_ = BoxGrid(boxes, 0.5 * sum_mm / static_cast<double>(boxes.size()));
  surface_.emplace(skin_of(elements));
}

glm::dvec3 NodeMotion::displacement_mm(const glm::dvec3& p_mm) const {
  // A point on a face that two elements share is inside one of them in spite of rounding.
  constexpr double slack = 1e-9;
  std::optional<glm::dvec3> found;
  if (const glm::ivec3 cell = cells_.cell_of(p_mm); cells_.has(cell))
    cells_.any_in(cell, [&](std::uint32_t number) {
      const auto& tet = tets_[number];
      const glm::dvec4 shares =
          shares_of(p_mm, {nodes_mm_[tet[0]], nodes_mm_[tet[1]], nodes_mm_[tet[2]], nodes_mm_[tet[3]]});
      if (!(shares.x >= -slack && shares.y >= -slack && shares.z >= -slack && shares.w >= -slack))
        return false;
      found = shares.x * displacement_mm_[tet[0]] + shares.y * displacement_mm_[tet[1]] +
              shares.z * displacement_mm_[tet[2]] + shares.w * displacement_mm_[tet[3]];
      return true;
    });
  if (found) return *found;
  // Shifts the point as the definition of the field states, so that one of several equally near points is
  // chosen.
  const auto foot =
      surface_->nearest(p_mm + 1e-6 * glm::dvec3(1.0, 0.618, 0.382), std::numeric_limits<double>::infinity());
  const auto& [a, b, c] = surface_->triangles().faces[foot->face];
  const glm::dvec3 beyond_mm = glm::max(glm::max(low_mm_ - p_mm, p_mm - high_mm_), glm::dvec3(0.0));
  const double r = std::min(glm::length(beyond_mm) / fade_mm_, 1.0);
  return std::pow(1.0 - r, 4) * (4.0 * r + 1.0) *
         (foot->weights.x * displacement_mm_[a] + foot->weights.y * displacement_mm_[b] +
          foot->weights.z * displacement_mm_[c]);
}

bool NodeMotion::turns_over() const {
  return std::any_of(tets_.begin(), tets_.end(), [&](const auto& tet) {
    std::array<glm::dvec3, 4> still, moved;
    for (std::size_t k = 0; k < 4; ++k) {
      still[k] = nodes_mm_[tet[k]] - nodes_mm_[tet[0]];
      moved[k] = still[k] + displacement_mm_[tet[k]] - displacement_mm_[tet[0]];
    }
    const auto side = [](const std::array<glm::dvec3, 4>& p) {
      return glm::dot(glm::cross(p[1], p[2]), p[3]);
    };
    return side(still) * side(moved) <= 0.0;
  });
}

std::optional<glm::dvec3> NodeMotion::origin_mm(const glm::dvec3& p_mm, const glm::dvec3& guess_mm) const {
  return origin_under(*this, p_mm, guess_mm);
}

ReshapedSurface surface_warped(const brep::Triangles& still, const NodeMotion& motion) {
  // The error of a corner's weight is some roundings of coordinates, divided by the element's height.
  constexpr double shares_of_flat_elements = 1e4;
  return surface_moved(still, motion, shares_of_flat_elements * 64.0,
                       "64e4 eps |p|: the same displacements by other code");
}

Witness witness_of_warped(Witness still, const brep::Triangles& still_surface,
                          std::shared_ptr<const NodeMotion> motion) {
  if (!still || motion->turns_over()) return {};
  return witness_of_moved_points(std::move(still), still_surface, std::move(motion));
}

}  // namespace octotomy::verify
