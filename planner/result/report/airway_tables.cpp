// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/airway_tables.h"

#include <algorithm>

#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string number(const std::optional<double>& value, int decimals) {
  return value ? grouped(*value, decimals) : "\u2013";
}

/// A plot of the area along the line, with both kernels' answers and the narrowest section.
std::string plot(const AirwaySize& airway) {
  constexpr double width = 640.0, height = 180.0, left = 52.0, below = 34.0, above = 12.0;
  double most = 1.0;
  for (const MeasuredSection& section : airway.sections) most = std::max(most, section.area_mm2);
  const auto x = [&](double mm) { return fixed(left + (width - left - 8.0) * mm / airway.length_mm); };
  const auto y = [&](double mm2) { return fixed(above + (height - above - below) * (1.0 - mm2 / most)); };
  const auto line = [&](const auto& area_of, const char* colour, const char* dashes) {
    std::string path;
    for (const MeasuredSection& section : airway.sections)
      if (const std::optional<double> mm2 = area_of(section))
        path += (path.empty() ? "M" : "L") + x(section.along_mm) + " " + y(*mm2);
    return path.empty() ? std::string()
                        : "<path fill=\"none\" stroke=\"" + std::string(colour) + "\" stroke-width=\"1.6\" " +
                              dashes + " d=\"" + path + "\"/>";
  };
  const auto text = [&](const std::string& at_x, const std::string& at_y, const char* anchor,
                        const std::string& words) {
    return "<text font-size=\"12\" font-family=\"sans-serif\" fill=\"var(--soft)\" x=\"" + at_x + "\" y=\"" +
           at_y + "\" text-anchor=\"" + anchor + "\">" + words + "</text>";
  };
  return "<svg role=\"img\" aria-label=\"Area of the airway along its centre line\" viewBox=\"0 0 " +
         fixed(width) + " " + fixed(height) + "\" style=\"max-width:" + fixed(width) +
         "px\"><path stroke=\"var(--soft)\" d=\"M" + fixed(left) + " " + fixed(above) + "V" +
         fixed(height - below) + "H" + fixed(width) + "\" fill=\"none\"/>" +
         line([](const MeasuredSection& section) { return std::optional(section.voxel_mm2); },
              "var(--second)", "stroke-dasharray=\"4 3\"") +
         line([](const MeasuredSection& section) { return section.mesh_mm2; }, "var(--accent)", "") +
         "<circle r=\"4\" fill=\"none\" stroke=\"var(--fail)\" stroke-width=\"2\" cx=\"" +
         x(airway.narrowest.along_mm) + "\" cy=\"" + y(airway.narrowest.area_mm2) + "\"/>" +
         text(fixed(left - 6.0), fixed(above + 8.0), "end", three_figures(most)) +
         text(fixed(left - 6.0), fixed(height - below), "end", "0") +
         text(fixed(left), fixed(height - below + 16.0), "start", "0") +
         text(fixed(width), fixed(height - below + 16.0), "end", three_figures(airway.length_mm) + " mm") +
         text(fixed(0.5 * (left + width)), fixed(height - 6.0), "middle",
              "mm\u00b2 along the centre line; blue: mesh kernel, orange: voxel kernel, circle: narrowest") +
         "</svg>";
}

}  // namespace

std::string airway_tables(const std::vector<Measurement>& measurements) {
  std::string made;
  for (const Measurement& one : measurements) {
    if (!one.airway) continue;
    const AirwaySize& airway = one.airway->airway;
    const MeasuredSection& least = airway.narrowest;
    const std::string rows =
        "<tr><th></th><th class=\"n\">recommended</th><th class=\"n\">voxel kernel</th><th class=\"n\">mesh "
        "kernel</th></tr><tr>" +
        cell("volume, mm\u00b3") +
        figure_cell(number(airway.volume_mm3, 0) + " \u00b1 " + three_figures(airway.volume_half_width_mm3)) +
        figure_cell(number(airway.volume_mm3, 0)) + figure_cell(number(airway.volume_mesh_mm3, 0)) +
        "</tr><tr>" + cell("narrowest section, mm\u00b2") +
        figure_cell(number(least.area_mm2, 1) + " \u00b1 " + three_figures(least.half_width_mm2)) +
        figure_cell(number(least.voxel_mm2, 1)) + figure_cell(number(least.mesh_mm2, 1)) + "</tr>";
    made += element("h3", "Airway " + escaped(one.id)) + element("table", rows) +
            element("p", "Narrowest " + number(least.along_mm, 1) + " mm along its centre line of " +
                             number(airway.length_mm, 1) + " mm, at x " + number(least.at_mm.x, 1) + ", y " +
                             number(least.at_mm.y, 1) + ", z " + number(least.at_mm.z, 1) +
                             " mm. Sections nearer to an end than the airway's radius are ignored, because "
                             "the centre line is unreliable there.") +
            plot(airway) + list(one.airway->findings);
  }
  return made;
}

}  // namespace octotomy::planner
