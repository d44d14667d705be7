// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/flap_tables.h"

#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string number(const std::optional<double>& value, int decimals, const std::string& unit) {
  return value ? grouped(*value, decimals) + unit : "\u2013";
}

std::string cut(const DonorCut& cut) {
  return number(cut.at_mm, 1, " mm, ") + number(cut.tilt_deg, 1, "\u00b0");
}

std::string segments(const MeasuredFlap& flap) {
  std::string rows =
      "<tr><th>Segment</th><th class=\"n\">length</th><th class=\"n\">shortest side</th><th "
      "class=\"n\">longest side</th><th class=\"n\">angle to the one before</th><th class=\"n\">first cut on "
      "the donor</th><th class=\"n\">second cut</th></tr>";
  for (const MeasuredSegment& one : flap.flap_segments)
    rows += "<tr>" + cell(std::to_string(one.number) + ". " + escaped(one.object)) +
            figure_cell(number(one.length_mm, 1, " mm")) + figure_cell(number(one.shortest_mm, 1, " mm")) +
            figure_cell(number(one.longest_mm, 1, " mm")) +
            figure_cell(number(one.angle_to_last_deg, 1, "\u00b0")) + figure_cell(cut(one.first_cut)) +
            figure_cell(cut(one.second_cut)) + "</tr>";
  return element("table", rows);
}

std::string osteotomies(const MeasuredFlap& flap) {
  std::string rows =
      "<tr><th>Osteotomy</th><th>between</th><th class=\"n\">contact, voxel kernel</th><th "
      "class=\"n\">contact, mesh kernel</th><th class=\"n\">allowed difference</th><th>certificate</th></tr>";
  for (const MeasuredOsteotomy& one : flap.osteotomies)
    rows += "<tr>" + cell(std::to_string(one.number) + ". " + escaped(one.object)) +
            cell(escaped(one.between.at(0)) + " and " + escaped(one.between.at(1))) +
            figure_cell(number(one.contact_voxels_mm2, 0, " mm\u00b2")) +
            figure_cell(number(one.contact_mesh_mm2, 0, " mm\u00b2")) +
            figure_cell(number(one.tolerance_mm2, 0, " mm\u00b2")) +
            cell(one.verdict ? escaped(*one.verdict) : "\u2013") + "</tr>" +
            (one.finding ? "<tr><td colspan=\"6\">" + escaped(*one.finding) + "</td></tr>" : "");
  return element("table", rows);
}

}  // namespace

std::string flap_tables(const std::vector<Measurement>& measurements) {
  std::string made;
  for (const Measurement& one : measurements) {
    if (!one.flap) continue;
    const MeasuredFlap& flap = *one.flap;
    made +=
        element("h3", "Free flap " + escaped(one.id)) + segments(flap) + osteotomies(flap) +
        element("p class=\"soft small\"",
                "Segments are in their order along the curve and along the donor, which gives " +
                    number(flap.donor_used_mm, 1, " mm") +
                    ". Lengths are along the axis; sides are as far out as the bone may reach. Cuts are told "
                    "by their place along the donor's axis from its first point and their tilt from a square "
                    "cut. Contact: " +
                    escaped(flap.contact_estimator) + ".");
  }
  return made;
}

}  // namespace octotomy::planner
