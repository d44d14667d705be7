// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "verify/interval/size_interval.h"
#include "voxel/space/progress.h"
#include "voxel/space/scene.h"

// Do the intervals hold the truth as often as they claim, and are they no wider than that takes?
namespace octotomy::verify {

/// The intervals of one kind of solid, spacing and sampling; empty words stand for all.
struct IntervalCoverage {
  std::string quantity;  ///< "volume" or "area"
  std::string group, spacing, sampling;
  int cases = 0;
  double held = 0.0;  ///< the share of cases whose interval holds the truth
  double p99_share =
      0.0;  ///< 99th percentile of |error| / half-width: the width is 1 / this times the error's
  double bias_percent = 0.0, p99_error_percent = 0.0;  ///< of the recommended value
  double median_width_percent = 0.0;                   ///< of the half-width, by the truth
};

/// Measures what a scan has from `low` on.
using MeasureSizes = std::function<SizeIntervals(const voxel::Scene& scan, double low)>;

struct IntervalSuiteOptions {
  int solids = 400;  ///< shared out over all groups, spacings and samplings
  std::uint64_t seed = 1;
  voxel::Progress progress = {};
  MeasureSizes measure = {};  ///< of drawn_suite(): what is tried. None: the surface and the sum of samples
};

/// Solids of measured_groups() in random poses at spacings 1:1:1 to 5:1:1, as shares, as a blurred scan with
/// noise, and as one with noise and a tilted gantry, straightened; a row for each, and in front one for each
/// quantity of all. Throws std::invalid_argument without a solid; voxel::Stopped. Parallel; same answer on
/// any thread count. Cost: about 0.2 s a solid.
std::vector<IntervalCoverage> interval_suite(const IntervalSuiteOptions& options = {});

/// Solids of drawn_groups() and scans of them, all by chance: a row for each class, and in front of each
/// quantity's rows one of the classes held back from calibration and one of the others; `sampling` is "held
/// back" or "calibrated". A solid has the numbers that measuring its scan at the half level has. Throws and
/// threads as interval_suite(). Cost: about a second a solid.
std::vector<IntervalCoverage> drawn_suite(const IntervalSuiteOptions& options = {});

/// What is asked of them.
inline constexpr double least_held = 0.985, least_held_of_a_class = 0.95, least_p99_share = 1.0 / 3.0;
/// Whether a row misses no more often than intervals that hold with probability `least` do in 99 of 100 runs.
bool is_likely(const IntervalCoverage& row, double least);

}  // namespace octotomy::verify
