// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/result/report/report.h"

namespace octotomy::planner {

/// The result as one self-contained HTML page with styles and pictures, without scripts or network access,
/// for screens and for printing on A4.
std::string report_html(const Result& result);

}  // namespace octotomy::planner
