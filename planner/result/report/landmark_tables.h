// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/result/report/measurement.h"

namespace octotomy::planner {

/// Proposed landmarks and those that were not found, as HTML, with a note that nobody has confirmed them;
/// empty if none were requested.
std::string landmark_tables(const std::vector<Measurement>& measurements);

}  // namespace octotomy::planner
