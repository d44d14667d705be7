// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/cohort/statistics.h"

// Plots as SVG, in colours that follow the page around them: light or dark.
namespace octotomy::planner {

/// The distribution of numbers: a histogram with its median, and ticks below for outliers. `unit` as shown to
/// users. Precondition: there are numbers, all finite.
std::string distribution_svg(const std::string& title, const std::string& unit,
                             const std::vector<double>& numbers);

/// Differences over means, with bias and limits of agreement. Precondition: there are points, all finite.
std::string agreement_svg(const std::string& title, const std::string& unit, const Agreement& agreement);

}  // namespace octotomy::planner
