// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/landmark_tables.h"

#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string row_of(const Json& guess) {
  std::string row =
      cell(escaped(guess.at("name").get<std::string>())) + cell(escaped(guess.at("says").get<std::string>()));
  for (const Json& part : guess.at("point_mm")) row += figure_cell(grouped(part.get<double>(), 1));
  return element("tr", row + figure_cell(grouped(guess.at("uncertainty_mm").get<double>(), 1)));
}

}  // namespace

std::string landmark_tables(const Json& measurements) {
  std::string made;
  for (const Json& one : measurements) {
    if (!one.contains("landmarks") || !one.contains("missing")) continue;
    std::string rows =
        "<tr><th></th><th></th><th class=\"n\">x, mm</th><th class=\"n\">y, mm</th><th class=\"n\">z, "
        "mm</th><th class=\"n\">within, mm</th></tr>";
    for (const Json& guess : one.at("landmarks")) rows += row_of(guess);
    std::string missing;
    for (const Json& lost : one.at("missing"))
      missing += element(
          "li", escaped(lost.at("name").get<std::string>() + ": " + lost.at("why").get<std::string>()));
    made +=
        element("h3", "First guess of landmarks, " + escaped(one.at("id").get<std::string>())) +
        element("p",
                "By the skull's symmetry and its extremal points. Nobody has confirmed them, and no number "
                "of this plan rests on them.") +
        element("table", rows);
    if (!missing.empty()) made += element("p", "Not found:") + element("ul", missing);
    made += list(one.at("findings").get<std::vector<std::string>>());
  }
  return made;
}

}  // namespace octotomy::planner
