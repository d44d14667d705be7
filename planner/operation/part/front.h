// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "brep/mesh/solid.h"
#include "planner/operation/part/arch_band.h"

namespace octotomy::planner {

/// The first point of a bone that a line of sight meets.
struct Seen {
  double depth_mm = 0.0;   ///< p . look
  glm::dvec3 normal{0.0};  ///< unit normal of the triangle there, LPS
  std::uint32_t face = 0;  ///< of the bone's triangles
};

/// The part of a bone's surface that is visible along `look` of a frame, within a box of the view.
class Front {
 public:
  /// `low` and `high` are corners of the box in the frame's millimetres (u, v).
  Front() = default;
  Front(const brep::Solid& bone, const ArchFrame& frame, const glm::dvec2& low, const glm::dvec2& high);

  /// The first point of the bone on the line of sight through a position (u, v) of the view; none if the line
  /// meets no bone.
  std::optional<Seen> first(const glm::dvec2& p_mm) const;
  /// The smallest p . look over the bone's points within the box; none if there are no such points.
  const std::optional<double>& foremost_mm() const { return foremost_mm_; }

 private:
  brep::Triangles turned_;  ///< points as (p . look, p . right, p . up)
  std::vector<std::uint32_t> face_of_;
  glm::dmat3 lps_from_turned_{1.0};
  std::optional<double> foremost_mm_;
  std::shared_ptr<const brep::SurfaceTree> tree_;
};

}  // namespace octotomy::planner
