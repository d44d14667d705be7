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

/// A point of a piece: the plan's displacement and the achieved one, and the interval of the latter that
/// holds in 99 of 100 cases, along the head's directions.
struct PointOutcome {
  std::string name;  ///< of a landmark; the piece's own for its centroid
  Displacement planned, achieved;
  Displacement half_width;
  double off_mm = 0.0;  ///< between planned and achieved place
};

struct PieceOutcome {
  std::string object;                      ///< moved, as the plan leaves it
  std::string still;                       ///< as it lies in the scan
  glm::dmat4 planned{1.0}, achieved{1.0};  ///< LPS to LPS of the plan's scan
  Turns planned_turns, achieved_turns;
  Turns turn_half_width;
  std::vector<PointOutcome> points;       ///< the centroid, then the landmarks that go with the piece
  double rms_mm = 0.0, kept_share = 0.0;  ///< of the fit
  std::vector<std::string> findings;
};

struct Outcome {
  std::string unmoved;  ///< the object that both scans are laid on each other by
  glm::dmat4 after_from_before{1.0};
  double rms_mm = 0.0, kept_share = 0.0;
  std::vector<std::string> findings;
  std::vector<PieceOutcome> pieces;
};

struct OutcomeOptions {
  std::string unmoved = {};        ///< default: the largest object that shares no bone with a moved piece
  std::optional<double> low = {};  ///< the lowest sample of the later scan that is bone; default: the plan's
  voxel::Progress progress = {};
};

/// Lays the plan's pieces on a scan after the operation. The evaluation needs meshes. Intervals are of what
/// noise and lattices leave open, for bone that has kept its shape: swelling, bent or resorbed bone is seen
/// in the fits' rms only. Throws std::runtime_error where nothing moves, an object has no mesh or the later
/// scan no bone; Stopped. Cost: an isosurface and a registration a piece, some seconds a head.
Outcome outcome_of(const Plan& plan, const Evaluation& evaluation, const voxel::Scene& after,
                   const OutcomeOptions& options = {});

nlohmann::ordered_json to_json(const Outcome& outcome);

}  // namespace octotomy::planner
