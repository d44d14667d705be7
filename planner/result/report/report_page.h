// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/result/report/report.h"

namespace octotomy::planner {

/// The data of the report page: result_json(), and patients and pictures, which only people see. Members:
/// interface Report of planner/result/page/result.ts.
nlohmann::ordered_json report_data(const Result& result);

/// The result as one self-contained HTML page, for screens and for printing on A4.
std::string report_html(const Result& result);

/// The counts of to_json(), and how many of PASS are not resolved.
nlohmann::ordered_json page_counts(const VerdictCounts& counts);
/// The colours of signed distances, from the most negative to the largest, as #rrggbb.
std::vector<std::string> distance_colours();

}  // namespace octotomy::planner
