// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/part/arch_band.h"
#include "planner/operation/table/bench.h"

// The slots of a guide, from the cuts of a plan.
namespace octotomy::planner {

/// A polyline that is swept along a direction, like the blade of a saw, in a form for each kernel.
struct Blade {
  std::vector<glm::dvec3> line_mm;  ///< LPS mm; p . direction is the same for all points
  glm::dvec3 direction{0, 1, 0};    ///< unit
  double depth_mm = 1.0;

  brep::Solid solid(double width_mm) const;
  voxel::Expression expression(double width_mm) const;
  voxel::RegionMask sides(double width_mm) const;
};

/// A slot through a guide: the opening for the saw, and the walls that guide the saw.
struct SawSlot {
  std::string cut;              ///< name of the step that makes the cut
  glm::dvec3 goes_in{0, 1, 0};  ///< unit: the direction in which the saw enters the bone
  double kerf_mm = 1.0;         ///< of the cut
  double length_mm = 0.0;       ///< length of its opening along the bone
  Blade opening, walls;         ///< at closed ends, walls extend beyond the opening
};

/// The region of a guide in which slots are made, and the measures of the slots.
struct SlotsAsked {
  Slab base;                  ///< the guide's region
  glm::dvec3 along{0, 1, 0};  ///< unit: the direction in which the guide is put on
  std::function<std::optional<glm::dvec3>(const glm::dvec2& p_mm)>
      bone_at;                ///< the bone at a position (u, v) of the base's view, LPS mm; none if there is
                              ///< none
  double mask_kerf_mm = 1.0;  ///< width of the saw's cut for masks, which do not state one
  double end_mm = 4.0;        ///< length of the wall beyond a closed end
  bool is_open = false;       ///< whether the end at the line's last point is open
  double margin_mm = 20.0;    ///< openings extend this far before and behind the bone
};

/// The slots of a saw step, a mask or a flap's space. Throws std::runtime_error that names the step if it
/// makes no cut, if the saw enters from another side, or if the cut misses the region.
std::vector<SawSlot> slots_of(const std::string& cut, const SlotsAsked& asked, const SettleBench& bench);

}  // namespace octotomy::planner
