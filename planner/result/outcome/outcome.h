// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/anatomy/head_directions.h"
#include "planner/plan/evaluate.h"
#include "voxel/space/scene.h"

namespace octotomy::planner {

/// A point of a piece, with its planned and its achieved displacement along the head's directions. The
/// achieved one ± half_width contains the true one in 99 of 100 cases.
struct PointOutcome {
  std::string name;  ///< a landmark, or the piece for its centroid
  Displacement planned, achieved;
  Displacement half_width;
  double off_mm = 0.0;  ///< distance between the planned and the achieved position
};

struct PieceOutcome {
  std::string object;                      ///< id of the object after its last motion
  std::string still;                       ///< id of the object where the scan shows it
  glm::dmat4 planned{1.0}, achieved{1.0};  ///< from LPS to LPS of the plan's scan
  Turns planned_turns, achieved_turns;
  Turns turn_half_width;
  std::vector<PointOutcome> points;       ///< the centroid, then landmarks that move with the piece
  double rms_mm = 0.0, kept_share = 0.0;  ///< of the fit
  std::vector<std::string> findings;
};

struct Outcome {
  std::string unmoved;  ///< id of the object by which the later scan is aligned with the plan's
  glm::dmat4 after_from_before{1.0};
  double rms_mm = 0.0, kept_share = 0.0;
  std::vector<std::string> findings;
  std::vector<PieceOutcome> pieces;
};

struct OutcomeOptions {
  std::string unmoved = {};        ///< id; default: the largest object that shares no bone with a moved piece
  std::optional<double> low = {};  ///< lower bound of bone in the later scan; default: that of the plan
  voxel::Progress progress = {};
};

/// Compares a plan with a scan after the operation, by fitting the plan's pieces to it. The evaluation must
/// contain meshes. The intervals cover noise and sampling, if the bone has kept its shape; swelling, bent or
/// resorbed bone shows only in the rms of the fits. Throws std::runtime_error if the plan moves nothing, if
/// an object has no mesh, or if the later scan has no bone; Stopped. Cost: an isosurface and a registration
/// for each piece, some seconds for a head.
Outcome outcome_of(const Plan& plan, const Evaluation& evaluation, const voxel::Scene& after,
                   const OutcomeOptions& options = {});

nlohmann::ordered_json to_json(const Outcome& outcome);

}  // namespace octotomy::planner
