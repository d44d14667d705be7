// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "verify/interval/size_interval.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Measures how often the intervals hold the truth, and whether they are wider than necessary.
namespace octotomy::verify {

/// The coverage of the intervals for one group of solids, one spacing and one sampling. An empty string
/// stands for all groups, spacings or samplings.
struct IntervalCoverage {
  std::string quantity;  ///< "volume" or "area"
  std::string group, spacing, sampling;
  int cases = 0;
  double held = 0.0;  ///< the share of cases whose interval holds the truth
  /// 99th percentile of |error| / half-width. The half-width is 1 / p99_share times the necessary one.
  double p99_share = 0.0;
  double bias_percent = 0.0, p99_error_percent = 0.0;  ///< of the recommended value
  double median_width_percent = 0.0;                   ///< of the half-width, in per cent of the truth
};

/// Returns the intervals of an object: the samples of a scan from `low` on.
using MeasureSizes = std::function<SizeIntervals(const voxel::Scene& scan, double low)>;

struct IntervalSuiteOptions {
  int solids = 400;  ///< number of solids, divided among all groups, spacings and samplings
  std::uint64_t seed = 1;
  voxel::Progress progress = {};
  /// The measurement that drawn_suite() tests. Empty: by the surface and by the sum of samples.
  MeasureSizes measure = {};
};

/// Tests solids of measured_groups() in random poses at spacings 1:1:1 to 5:1:1. They are sampled as shares,
/// as a blurred scan with noise, and as a blurred scan with noise whose tilted gantry is straightened.
/// Returns one row for each combination; before these, one row per quantity over all combinations. Throws
/// std::invalid_argument if there are no solids; voxel::Stopped. Parallel; same answer on any thread count.
/// Cost: about 0.2 s a solid.
std::vector<IntervalCoverage> interval_suite(const IntervalSuiteOptions& options = {});

/// Tests random solids of drawn_groups() in random scans. Returns one row for each class. Before the rows of
/// each quantity there is one row for the classes held back from calibration and one for the others, with the
/// `sampling` "held back" or "calibrated". Each scan is measured at its half level. Errors and threads as in
/// interval_suite(). Cost: about a second a solid.
std::vector<IntervalCoverage> drawn_suite(const IntervalSuiteOptions& options = {});

/// Required of the suites: the least share of cases whose interval holds the truth, overall and in each
/// class, and the least p99_share.
inline constexpr double least_held = 0.985, least_held_of_a_class = 0.95, least_p99_share = 1.0 / 3.0;
/// Whether the misses of a row may be due to chance. Assumes that each interval holds the truth with the
/// probability `least`. Returns false if at most one in 100 runs of such intervals would miss as often.
bool is_likely(const IntervalCoverage& row, double least);

}  // namespace octotomy::verify
