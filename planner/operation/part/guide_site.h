// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "brep/boolean/boolean.h"
#include "planner/operation/part/arch_band.h"
#include "planner/operation/part/front.h"
#include "planner/operation/table/bench.h"
#include "planner/operation/table/field.h"

// The region of a bone on which a guide or a plate sits, and the side from which it is put on.
namespace octotomy::planner {

/// A region drawn in a view.
struct DrawnSite {
  std::string view;
  Polygons polygons_mm;  ///< one
};

struct SiteAsked {
  std::string bone;  ///< the name of the object
  std::string side;  ///< a view of the head as it is held
  std::optional<glm::dvec3> direction;
  std::vector<glm::dvec3> points_mm;  ///< if no region is drawn
  double radius_mm = 10.0;            ///< of the region about the points
  std::optional<double> ends_mm;      ///< how far it extends beyond the first and last of several points;
                                      ///< none: by the radius
  std::optional<DrawnSite> drawn;
  double reach_mm = 25.0;      ///< behind the region's foremost bone
  double before_mm = 5.0;      ///< how far the guide extends before the bone
  double margin_mm = 5.0;      ///< how far beside the region bone is used
  std::string part = "guide";  ///< in messages
  bool is_on_several = false;  ///< the part may lie on several pieces of the bone
};

struct GuideSite {
  Slab base;                  ///< the region, from `before_mm` before to `reach_mm` behind the foremost bone
  Slab near;                  ///< the space whose bone shapes the part
  glm::dvec3 along{0, 1, 0};  ///< unit, LPS: the direction in which the guide is put on
  double end_mm = 0.0;        ///< position along `along` of the plane, 1 mm behind `base` and `near`, at
                              ///< which shadows end
  brep::BooleanResult bone;   ///< the bone's mesh within `near`
  Front front;                ///< of the bone about the region

  /// The visible bone at a position of the base's view, within the reach.
  std::optional<glm::dvec3> bone_at(const glm::dvec2& p_mm) const;
};

/// Computes where a part sits. Throws std::runtime_error, which names the remedy, if points lie off the bone,
/// on two bones or hidden behind bone; if the region lies on two bones or was drawn from another side; or if
/// the direction runs along the bone's sides or comes from another side.
GuideSite guide_site(const SiteAsked& asked, const SettleBench& bench);

}  // namespace octotomy::planner
