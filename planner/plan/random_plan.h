// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "planner/operation/measure/result_json.h"
#include "verify/question/expression_tree.h"
#include "verify/question/random_expression.h"

// Random plans for the bounded tier: windows on scans, masks, rigid motions, and expressions of these.
namespace octotomy::planner {

/// A scan for random plans, with the bounds of windows whose objects are neither empty nor the whole scan.
struct RandomScan {
  std::string name;
  std::filesystem::path path;
  double low_from = 0.0, low_to = 0.0;
};

/// Writes the scans into an existing folder: random waves within an ellipsoid, once with cubic and once with
/// oblong samples, and the head phantom with samples of 6 mm. The files are always the same, byte for byte.
std::vector<RandomScan> write_random_scans(const std::filesystem::path& folder);

/// A step of a random plan as JSON. The expression of a `combine` is stored apart, in `tree`.
struct RandomStep {
  Json json;
  verify::ExpressionTree tree;  ///< expression of a `combine`; its leaf i is the object operands[i]
  std::vector<std::string> operands;
};

struct RandomPlan {
  Json scans = Json::object();
  std::vector<RandomStep> steps;  ///< the last step makes the result
};

/// A plan of two to four objects, some of them moved, and an expression of them with up to six nested
/// operators. Occasionally the result is moved and combined again.
RandomPlan random_plan(verify::Random& random, const std::vector<RandomScan>& scans);

/// The plan's JSON.
std::string text(const RandomPlan& plan);

/// The plan with only those steps that the object needs, in their order.
RandomPlan up_to(const RandomPlan& plan, const std::string& id);

/// All plans with one operator, one motion or one region less.
std::vector<RandomPlan> simpler(const RandomPlan& plan);

}  // namespace octotomy::planner
