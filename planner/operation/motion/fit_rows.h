// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/operation/table/number_format.h"

namespace octotomy::planner {

/// The number of rounds of a fit and how it ended, such as "37, came to rest (0.00012 mm)".
inline std::string rounds_text(int rounds, bool converged, double last_step_mm, double rest_mm) {
  return std::to_string(rounds) +
         (converged ? ", came to rest: the last moved " : ", still moving: the last moved ") +
         three_figures(last_step_mm) + " mm, rest is " + three_figures(rest_mm) + " mm";
}

}  // namespace octotomy::planner
