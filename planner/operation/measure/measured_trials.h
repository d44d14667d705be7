// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/operation/measure/trials.h"
#include "planner/operation/table/record.h"

// The effect of errors on a plan's numbers: records below `measurements` in a result.
namespace octotomy::planner {

/// The half-width of a number that one source of error alone would cause.
struct TrialSource {
  std::string name;
  double half_width = 0.0;
};
constexpr auto members_of(const TrialSource&) {
  return std::tuple(member("name", &TrialSource::name), member("half_width", &TrialSource::half_width));
}

/// A number of the plan, with the half-width that all errors together cause.
struct DoubtfulNumber {
  std::string what, of;
  double value = 0.0;
  std::string unit;
  double half_width = 0.0, coverage = 0.0;
  std::vector<TrialSource> sources;
};
constexpr auto members_of(const DoubtfulNumber&) {
  using N = DoubtfulNumber;
  return std::tuple(member("what", &N::what), member("of", &N::of), member("value", &N::value),
                    member("unit", &N::unit), member("half_width", &N::half_width),
                    member("coverage", &N::coverage), member("sources", &N::sources));
}

/// The standard deviations of the errors; the number of trials and the seed are printed elsewhere.
constexpr auto members_of(const Trials&) {
  return std::tuple(member("landmark_mm", &Trials::landmark_mm), member("kerf_mm", &Trials::kerf_mm),
                    member("segmentation_mm", &Trials::segmentation_mm),
                    member("seating_mm", &Trials::seating_mm), member("seating_deg", &Trials::seating_deg));
}

struct MeasuredTrials {
  int trials = 0, seed = 0;
  Trials errors;
  std::vector<DoubtfulNumber> doubts;
  std::vector<std::string> findings;

  static constexpr const char* key = "doubts";
};
constexpr auto members_of(const MeasuredTrials&) {
  using T = MeasuredTrials;
  return std::tuple(member("trials", &T::trials), member("seed", &T::seed), member("errors", &T::errors),
                    member("doubts", &T::doubts), member("findings", &T::findings));
}

}  // namespace octotomy::planner
