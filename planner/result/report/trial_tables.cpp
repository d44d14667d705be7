// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/trial_tables.h"

#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string unit_of(const Json& doubt) {
  const auto unit = doubt.at("unit").get<std::string>();
  return unit == "deg" ? "\u00b0" : unit == "mm3" ? " mm\u00b3" : " " + unit;
}

/// The half-width of a source; "–" if there is none.
std::string of_source(const Json& doubt, const char* name) {
  for (const Json& source : doubt.at("sources"))
    if (source.at("name") == name) return three_figures(source.at("half_width").get<double>());
  return "\u2013";
}

}  // namespace

std::string trial_tables(const Json& measurements) {
  std::string made;
  for (const Json& trials : measurements) {
    if (!trials.contains("doubts")) continue;
    std::string rows =
        "<tr><th>Number</th><th>of</th><th class=\"n\">planned</th><th class=\"n\">landmarks</th><th "
        "class=\"n\">saw</th><th class=\"n\">segmentation</th><th class=\"n\">seating</th></tr>";
    for (const Json& doubt : trials.at("doubts")) {
      const int decimals = doubt.at("unit") == "mm3" ? 0 : 1;
      rows += "<tr>" + cell(escaped(doubt.at("what").get<std::string>())) +
              cell(escaped(doubt.at("of").get<std::string>())) +
              figure_cell(grouped(doubt.at("value").get<double>(), decimals) + " \u00b1 " +
                          three_figures(doubt.at("half_width").get<double>()) + unit_of(doubt));
      for (const char* source : {"landmarks", "kerf", "segmentation", "seating"})
        rows += figure_cell(of_source(doubt, source));
      rows += "</tr>";
    }
    const Json& errors = trials.at("errors");
    const auto error = [&](const char* key, const char* unit) {
      return plain(errors.at(key).get<double>()) + unit;
    };
    made +=
        element("h3", "How wrong it can be: " + escaped(trials.at("id").get<std::string>())) +
        element("table", rows) +
        element("p class=\"soft small\"",
                "After each \u00b1, the half-width that holds in 99 of 100 of " + trials.at("trials").dump() +
                    " trials with errors of these standard deviations: landmarks " +
                    error("landmark_mm", " mm") + " and a piece's seating " + error("seating_mm", " mm") +
                    " along each axis, its turn " + error("seating_deg", "\u00b0") +
                    " about each, the saw's width " + error("kerf_mm", " mm") + ", where bone ends " +
                    error("segmentation_mm", " mm") +
                    ". The further columns are the half-widths of each source alone. Gaps and overlaps are "
                    "computed to first order.") +
        list(trials.at("findings").get<std::vector<std::string>>());
  }
  return made;
}

}  // namespace octotomy::planner
