// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/trial_tables.h"

#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string unit_of(const DoubtfulNumber& doubt) {
  return doubt.unit == "deg" ? "\u00b0" : doubt.unit == "mm3" ? " mm\u00b3" : " " + doubt.unit;
}

/// The half-width of a source; "–" if there is none.
std::string of_source(const DoubtfulNumber& doubt, const char* name) {
  for (const TrialSource& source : doubt.sources)
    if (source.name == name) return three_figures(source.half_width);
  return "\u2013";
}

}  // namespace

std::string trial_tables(const std::vector<Measurement>& measurements) {
  std::string made;
  for (const Measurement& one : measurements) {
    if (!one.trials) continue;
    const MeasuredTrials& trials = *one.trials;
    std::string rows =
        "<tr><th>Number</th><th>of</th><th class=\"n\">planned</th><th class=\"n\">landmarks</th><th "
        "class=\"n\">saw</th><th class=\"n\">segmentation</th><th class=\"n\">seating</th></tr>";
    for (const DoubtfulNumber& doubt : trials.doubts) {
      const int decimals = doubt.unit == "mm3" ? 0 : 1;
      rows += "<tr>" + cell(escaped(doubt.what)) + cell(escaped(doubt.of)) +
              figure_cell(grouped(doubt.value, decimals) + " \u00b1 " + three_figures(doubt.half_width) +
                          unit_of(doubt));
      for (const char* source : {"landmarks", "kerf", "segmentation", "seating"})
        rows += figure_cell(of_source(doubt, source));
      rows += "</tr>";
    }
    const auto error = [&](double Trials::*of, const char* unit) { return plain(trials.errors.*of) + unit; };
    made +=
        element("h3", "How wrong it can be: " + escaped(one.id)) + element("table", rows) +
        element("p class=\"soft small\"",
                "After each \u00b1, the half-width that holds in 99 of 100 of " +
                    std::to_string(trials.trials) +
                    " trials with errors of these standard deviations: landmarks " +
                    error(&Trials::landmark_mm, " mm") + " and a piece's seating " +
                    error(&Trials::seating_mm, " mm") + " along each axis, its turn " +
                    error(&Trials::seating_deg, "\u00b0") + " about each, the saw's width " +
                    error(&Trials::kerf_mm, " mm") + ", where bone ends " +
                    error(&Trials::segmentation_mm, " mm") +
                    ". The further columns are the half-widths of each source alone. Gaps and overlaps are "
                    "computed to first order.") +
        list(trials.findings);
  }
  return made;
}

}  // namespace octotomy::planner
