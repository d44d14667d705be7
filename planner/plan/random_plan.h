// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "verify/question/expression_tree.h"
#include "verify/question/random_expression.h"

// Random plans, for the bounded tier: windows on scans, masks, rigid motions and expressions of them.
namespace octotomy::planner {

/// A scan for random plans, and window bounds for which objects are neither empty nor the whole scan.
struct RandomScan {
  std::string name;
  std::filesystem::path path;
  double low_from = 0.0, low_to = 0.0;
};

/// Writes the scans into a folder that exists: smooth random waves on cubic and on oblong samples, each
/// within an ellipsoid of its own, and the head phantom with samples of six millimetres. Always the same
/// bytes.
std::vector<RandomScan> write_random_scans(const std::filesystem::path& folder);

/// A step of a random plan: as JSON, without the expression of a `combine`.
struct RandomStep {
  Json json;
  verify::ExpressionTree tree;  ///< expression of a combine; leaf i is the object operands[i]
  std::vector<std::string> operands;
};

struct RandomPlan {
  Json scans = Json::object();
  std::vector<RandomStep> steps;  ///< the last is the result
};

/// Two to four objects, some of them moved, and an expression of them up to six operators deep; occasionally
/// the result is moved and combined again.
RandomPlan random_plan(verify::Random& random, const std::vector<RandomScan>& scans);

/// The plan's JSON.
std::string text(const RandomPlan& plan);

/// Only the steps that an object needs, in order.
RandomPlan up_to(const RandomPlan& plan, const std::string& id);

/// All plans that are simpler by one operator, one motion or one region.
std::vector<RandomPlan> simpler(const RandomPlan& plan);

}  // namespace octotomy::planner
