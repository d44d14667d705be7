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

// The place of a guide or plate: the region of the bone that it covers, and the side from which it is put on.
namespace octotomy::planner {

/// A region drawn in a view.
struct DrawnSite {
  std::string view;
  Polygons polygons_mm;  ///< one
};

struct SiteAsked {
  std::string bone;  ///< name of the bone's object
  std::string side;  ///< a view's name or angles, relative to the head's position
  std::optional<glm::dvec3> direction;
  std::vector<glm::dvec3> points_mm;  ///< points that the region surrounds, if no region is drawn
  double radius_mm = 10.0;            ///< half width of the region around the points
  std::optional<double> ends_mm;      ///< length of the region beyond the first and last of several points;
                                      ///< none: the radius
  std::optional<DrawnSite> drawn;
  double reach_mm = 25.0;      ///< the part extends this far behind the region's foremost bone
  double before_mm = 5.0;      ///< the part extends this far before the region's foremost bone
  double margin_mm = 5.0;      ///< bone within this distance beside the region is used
  std::string part = "guide";  ///< in messages
  bool is_on_several = false;  ///< whether the part may lie on several pieces of the bone
};

struct GuideSite {
  Slab base;                  ///< the region's volume, from `before_mm` before the foremost bone to
                              ///< `reach_mm` behind it
  Slab near;                  ///< the space around it; the bone within shapes the part
  glm::dvec3 along{0, 1, 0};  ///< unit, LPS: the direction in which the part is put on
  double end_mm = 0.0;        ///< position along `along` of the plane at which shadows end, 1 mm behind
                              ///< `base` and `near`
  brep::BooleanResult bone;   ///< the bone's mesh within `near`
  Front front;                ///< visible surface of the bone around the region

  /// The visible bone at a position (u, v) of the base's view, LPS mm; none if there is none within the
  /// reach.
  std::optional<glm::dvec3> bone_at(const glm::dvec2& p_mm) const;
};

/// Computes the place of a part. Throws std::runtime_error that states the remedy if points lie off the bone,
/// on two bones or hidden behind bone; if the region lies on two bones or was drawn from another side; or if
/// the direction runs along the bone's sides or comes from another side.
GuideSite guide_site(const SiteAsked& asked, const SettleBench& bench);

}  // namespace octotomy::planner
