// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "planner/plan/evaluate.h"

namespace octotomy::planner {

/// A markup of 3D Slicer, in LPS and millimetres.
struct SceneMarkup {
  std::string type;  ///< "Fiducial", "Plane", "ClosedCurve", "Curve" or "Line"
  std::string name;  ///< name of its node and its file
  nlohmann::ordered_json json;
};

/// The markups of a plan:
/// - its landmarks, one list;
/// - for each saw, a plane for each piece of its line: the rectangle that the blade sweeps, entered where the
///   coordinate along the plane's second axis is least; and the line itself if it has several pieces;
/// - for each mask, a closed curve for each polygon, in the plane through the universe's centre across the
///   view; and, if a polygon has at most `most_sides` sides, so that they may be cuts, a plane for each side
///   with its normal into the mask;
/// - for each screw, also a moved one, a line from its head to its tip.
/// Precondition: the plan was evaluated. Throws as the readers of the plan's files do.
std::vector<SceneMarkup> scene_markups(const Plan& plan, const Evaluation& evaluation);

/// Polygons with more sides were probably drawn by hand. They get only a curve, no planes.
inline constexpr std::size_t most_sides = 8;

}  // namespace octotomy::planner
