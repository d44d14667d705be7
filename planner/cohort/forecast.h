// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "planner/cohort/participant.h"

namespace octotomy::planner {

/// A quantity that grows linearly with the size of a subject's scans: at + per_byte * bytes.
struct Growth {
  double at = 0.0, per_byte = 0.0;

  double of(std::uint64_t bytes) const { return at + per_byte * static_cast<double>(bytes); }
};

/// Time and memory that a plan needs for a subject, estimated from `learnt_from` finished subjects.
struct Forecast {
  std::size_t learnt_from = 0;
  Growth seconds, peak_mb;
};

/// Fits time and memory by least squares over the sizes of scans. If all scans have about the same size, the
/// estimates are the largest values found, for every size. An estimate never decreases with size.
Forecast forecast_of(const std::vector<SubjectRecord>& done);

}  // namespace octotomy::planner
