// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "planner/operation/anatomy/movement.h"
#include "planner/procedure/cephalometry/definition.h"

namespace octotomy::planner {

/// A value and the half-width of an interval that contains the true value in 99 of 100 cases.
struct CephalometricValue {
  double value = 0.0, half_width = 0.0;
};
struct CephalometricResult {
  CephalometricMeasure measure;
  std::optional<std::string>
      norm_of;  ///< the people whom the norm describes; none if the definitions do not describe its source
  CephalometricValue before;
  /// None if nothing moves, or if the measure has a landmark on the skin whose motion nothing predicts. A
  /// change is more accurate than either value, because a landmark has the same error before and after.
  std::optional<CephalometricValue> after, change;
};
struct CephalometricResults {
  std::vector<CephalometricResult> measured;  ///< in the order in which they are defined
  /// Measures without a value after the operation, each with its landmarks on the skin whose motion nothing
  /// predicts.
  std::vector<std::pair<std::string, std::vector<std::string>>> unpredicted;
  /// Measures that cannot be computed, each with the landmarks that are not placed.
  std::vector<std::pair<std::string, std::vector<std::string>>> lacking;
};

struct LandmarkDoubt {
  double deviation_mm = 1.0;  ///< standard deviation of a landmark's position along each axis
  int trials = 10000;
  std::uint64_t seed = 1;
};

/// Computes all measures whose landmarks are placed. The intervals come from `trials` random trials. In a
/// trial each landmark has an independent, normally distributed error of its placement, and each motion by a
/// ratio an error of the ratio. Throws std::invalid_argument, which names the measure, if both points of a
/// line coincide. The same seed gives the same bits. Cost: less than a microsecond for each trial and measure
/// or landmark.
CephalometricResults measured(const Cephalometry& definitions, const std::vector<MovedLandmark>& landmarks,
                              const glm::dmat3& lps_from_head, const LandmarkDoubt& doubt = {});

/// {"measures": [{"name", "says", "unit", "before": {"value", "half_width"}, "after", "change", "norm",
/// "deviation", "source", "norm_of"}], "lacking": [{"name", "landmarks"}], "landmark_deviation_mm",
/// "coverage"}
nlohmann::ordered_json to_json(const CephalometricResults& results, const LandmarkDoubt& doubt);

}  // namespace octotomy::planner
