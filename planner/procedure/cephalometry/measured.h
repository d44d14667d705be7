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
      norm_of;  ///< the people whom the norm describes; none if its source is not described
  CephalometricValue before;
  /// None if nothing moved, and of measures of the skin that nothing predicts. A landmark's error is the same before and after, so a change is more accurate
  /// than either value.
  std::optional<CephalometricValue> after, change;
};
struct CephalometricResults {
  std::vector<CephalometricResult> measured;  ///< in the order of their definitions
  /// Measures of the skin that have no value after the operation, because nothing predicts the motion of these
  /// landmarks of theirs.
  std::vector<std::pair<std::string, std::vector<std::string>>> unpredicted;
  /// Measures that cannot be computed, each with its missing landmarks.
  std::vector<std::pair<std::string, std::vector<std::string>>> lacking;
};

struct LandmarkDoubt {
  double deviation_mm = 1.0;  ///< standard deviation of a landmark's placement, along each axis
  int trials = 10000;
  std::uint64_t seed = 1;
};

/// Computes the measures whose landmarks are known, from the placed landmarks. Intervals come from
/// `trials` trials in which each placed landmark has a random, independent, normally distributed error., and each motion
/// by a ratio another one of its own.
/// Throws std::invalid_argument, which names the measure, if a line's two points coincide. The same seed
/// produces the same bits. Cost: less than a microsecond per trial and measure or landmark.
CephalometricResults measured(const Cephalometry& definitions, const std::vector<MovedLandmark>& landmarks,
                              const glm::dmat3& lps_from_head, const LandmarkDoubt& doubt = {});

/// {"measures": [{"name", "says", "unit", "before": {"value", "half_width"}, "after", "change", "norm",
/// "deviation", "source", "norm_of"}], "lacking": [{"name", "landmarks"}], "landmark_deviation_mm", "coverage"}.
nlohmann::ordered_json to_json(const CephalometricResults& results, const LandmarkDoubt& doubt);

}  // namespace octotomy::planner
