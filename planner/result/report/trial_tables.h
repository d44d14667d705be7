// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/result/report/measurement.h"

namespace octotomy::planner {

/// The uncertainty of a plan's numbers from trials with errors of landmarks, saw, segmentation and seating,
/// as HTML; empty if no step requested trials.
std::string trial_tables(const std::vector<Measurement>& measurements);

}  // namespace octotomy::planner
