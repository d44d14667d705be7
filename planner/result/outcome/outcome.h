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

/// A point of a piece: the plan's displacement and the achieved one, and the interval that contains the
/// achieved one in 99 of 100 cases, along the head's directions.
struct PointOutcome {
  std::string name;  ///< name of a landmark, or of the piece for its centroid
  Displacement planned, achieved;
  Displacement half_width;
  double off_mm = 0.0;  ///< distance between planned and achieved position
};

struct PieceOutcome {
  std::string object;                      ///< the moved object at the end of the plan
  std::string still;                       ///< the object in its position in the scan
  glm::dmat4 planned{1.0}, achieved{1.0};  ///< LPS to LPS of the plan's scan
  Turns planned_turns, achieved_turns;
  Turns turn_half_width;
  std::vector<PointOutcome> points;       ///< the centroid, then the landmarks that move with the piece
  double rms_mm = 0.0, kept_share = 0.0;  ///< of the fit
  std::vector<std::string> findings;
};

struct Outcome {
  std::string unmoved;  ///< the object by which the two scans are aligned
  glm::dmat4 after_from_before{1.0};
  double rms_mm = 0.0, kept_share = 0.0;
  std::vector<std::string> findings;
  std::vector<PieceOutcome> pieces;
};

struct OutcomeOptions {
  std::string unmoved = {};        ///< default: the largest object that shares no bone with a moved piece
  std::optional<double> low = {};  ///< the lower bound of bone in the later scan; default: that of the plan
  voxel::Progress progress = {};
};

/// Fits the plan's pieces to a scan after the operation. The evaluation needs meshes. Intervals cover noise
/// and sampling for bone that has kept its shape: swelling, bent or resorbed bone shows only in the fits'
/// rms. Throws std::runtime_error if nothing moves, an object has no mesh or the later scan has no bone;
/// Stopped. Cost: an isosurface, and a registration per piece; some seconds for a head.
Outcome outcome_of(const Plan& plan, const Evaluation& evaluation, const voxel::Scene& after,
                   const OutcomeOptions& options = {});

nlohmann::ordered_json to_json(const Outcome& outcome);

}  // namespace octotomy::planner
