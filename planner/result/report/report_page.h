// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include "planner/result/report/report.h"

namespace octotomy::planner {

/// The data of a report's page: result_json(), and data that only the page contains, such as patients and
/// pictures. The members are those of the interface Report in planner/result/page/result.ts.
nlohmann::ordered_json report_data(const Result& result);

/// The report as one HTML page that needs no other file, for screens and for printing on A4.
std::string report_html(const Result& result);

/// The counts of to_json(), and in addition the number of PASS that are not resolved.
nlohmann::ordered_json page_counts(const VerdictCounts& counts);
/// The colours of signed distances as #rrggbb, from the most negative distance to the largest.
std::vector<std::string> distance_colours();

}  // namespace octotomy::planner
