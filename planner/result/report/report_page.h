// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "planner/result/report/report.h"

namespace octotomy::planner {

/// The result as one HTML page that needs nothing else: styles and pictures are in it, no script, no network.
/// Made to be read on a screen and printed on A4.
std::string report_html(const Result& result);

}  // namespace octotomy::planner
