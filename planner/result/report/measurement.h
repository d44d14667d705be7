// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/operation/flap/measured_flap.h"
#include "planner/operation/landmark/landmark_guesses.h"
#include "planner/operation/measure/measured_trials.h"
#include "planner/operation/measure/measurement.h"

namespace octotomy::planner {

/// A measurement of a plan. Only the members that its step computes have values.
struct Measurement {
  std::string id;  ///< of the step
  std::optional<MeasuredSize> size;
  std::optional<MeasuredGap> gap;
  std::optional<MeasuredDistance> distance;
  std::optional<MeasuredAngle> angle;
  std::optional<MeasuredContacts> contacts;
  std::optional<MeasuredAirway> airway;
  std::optional<MeasuredFlap> flap;
  std::optional<LandmarkGuesses> landmarks;
  std::optional<MeasuredTrials> trials;
};

void read_value(const Json& json, Measurement& measurement);

/// Reads the JSON of measurements_json(), or the `measurements` of a result.
std::vector<Measurement> measurements_of(const Json& measurements);

}  // namespace octotomy::planner
