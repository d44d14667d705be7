// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "planner/cohort/statistics.h"

// Plots as SVG, in the colours of the surrounding page, light or dark.
namespace octotomy::planner {

/// A histogram of the numbers with their median, and below it a tick for each outlier. `unit` is written as
/// given, such as "mm³". Precondition: at least one number, all finite.
std::string distribution_svg(const std::string& title, const std::string& unit,
                             const std::vector<double>& numbers);

/// Differences of two methods against their means, with bias and limits of agreement. Precondition: at least
/// one point, all finite.
std::string agreement_svg(const std::string& title, const std::string& unit, const Agreement& agreement);

}  // namespace octotomy::planner
