// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/landmark_tables.h"

#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string row_of(const GuessedLandmark& guess) {
  std::string row = cell(escaped(guess.name)) + cell(escaped(guess.says));
  for (int axis = 0; axis < 3; ++axis) row += figure_cell(grouped(guess.point_mm[axis], 1));
  return element("tr", row + figure_cell(grouped(guess.uncertainty_mm, 1)));
}

}  // namespace

std::string landmark_tables(const std::vector<Measurement>& measurements) {
  std::string made;
  for (const Measurement& one : measurements) {
    if (!one.landmarks) continue;
    std::string rows =
        "<tr><th></th><th></th><th class=\"n\">x, mm</th><th class=\"n\">y, mm</th><th class=\"n\">z, "
        "mm</th><th class=\"n\">within, mm</th></tr>";
    for (const GuessedLandmark& guess : one.landmarks->landmarks) rows += row_of(guess);
    std::string missing;
    for (const MissingLandmark& lost : one.landmarks->missing)
      missing += element("li", escaped(lost.name + ": " + lost.why));
    made +=
        element("h3", "First guess of landmarks, " + escaped(one.id)) +
        element("p",
                "By the skull's symmetry and its extremal points. Nobody has confirmed them, and no number "
                "of this plan rests on them.") +
        element("table", rows);
    if (!missing.empty()) made += element("p", "Not found:") + element("ul", missing);
    made += list(one.landmarks->findings);
  }
  return made;
}

}  // namespace octotomy::planner
