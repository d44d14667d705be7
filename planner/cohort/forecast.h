// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "planner/cohort/participant.h"

namespace octotomy::planner {

/// A quantity that grows with a scan's size: at + per_byte * bytes.
struct Growth {
  double at = 0.0, per_byte = 0.0;

  double of(std::uint64_t bytes) const { return at + per_byte * static_cast<double>(bytes); }
};

/// The resources that subjects of a plan need, estimated from those that are done.
struct Forecast {
  std::size_t learnt_from = 0;
  Growth seconds, peak_mb;
};

/// Fits by least squares; if all scans have about the same size, returns the largest values for any size.
/// Growth is never negative.
Forecast forecast_of(const std::vector<SubjectRecord>& done);

}  // namespace octotomy::planner
