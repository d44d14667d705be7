// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/flap_tables.h"

#include "planner/operation/table/json.h"
#include "planner/operation/table/number_format.h"
#include "planner/result/report/html.h"

namespace octotomy::planner {
namespace {

std::string number(const Json& json, int decimals, const std::string& unit) {
  return json.is_number() ? grouped(json.get<double>(), decimals) + unit : "\u2013";
}

std::string name(const Json& json) {
  return json.is_string() ? escaped(json.get<std::string>()) : "\u2013";
}

std::string cut(const Json& cut) {
  return number(cut.at("at_mm"), 1, " mm, ") + number(cut.at("tilt_deg"), 1, "\u00b0");
}

std::string segments(const Json& flap) {
  std::string rows =
      "<tr><th>Segment</th><th class=\"n\">length</th><th class=\"n\">shortest side</th><th "
      "class=\"n\">longest side</th><th class=\"n\">angle to the one before</th><th class=\"n\">first cut on "
      "the donor</th><th class=\"n\">second cut</th></tr>";
  for (const Json& one : flap.at("flap_segments"))
    rows += "<tr>" + cell(one.at("number").dump() + ". " + name(one.at("object"))) +
            figure_cell(number(one.at("length_mm"), 1, " mm")) +
            figure_cell(number(one.at("shortest_mm"), 1, " mm")) +
            figure_cell(number(one.at("longest_mm"), 1, " mm")) +
            figure_cell(number(one.at("angle_to_last_deg"), 1, "\u00b0")) +
            figure_cell(cut(one.at("first_cut"))) + figure_cell(cut(one.at("second_cut"))) + "</tr>";
  return element("table", rows);
}

std::string osteotomies(const Json& flap) {
  std::string rows =
      "<tr><th>Osteotomy</th><th>between</th><th class=\"n\">contact, voxel kernel</th><th "
      "class=\"n\">contact, mesh kernel</th><th class=\"n\">allowed difference</th><th>certificate</th></tr>";
  for (const Json& one : flap.at("osteotomies"))
    rows +=
        "<tr>" + cell(one.at("number").dump() + ". " + name(one.at("object"))) +
        cell(name(one.at("between").at(0)) + " and " + name(one.at("between").at(1))) +
        figure_cell(number(one.at("contact_voxels_mm2"), 0, " mm\u00b2")) +
        figure_cell(number(one.at("contact_mesh_mm2"), 0, " mm\u00b2")) +
        figure_cell(number(one.at("tolerance_mm2"), 0, " mm\u00b2")) + cell(name(one.at("verdict"))) +
        "</tr>" +
        (one.contains("finding") ? "<tr><td colspan=\"6\">" + name(one.at("finding")) + "</td></tr>" : "");
  return element("table", rows);
}

}  // namespace

std::string flap_tables(const Json& measurements) {
  std::string made;
  for (const Json& flap : measurements) {
    if (!flap.contains("flap_segments")) continue;
    made +=
        element("h3", "Free flap " + name(flap.at("id"))) + segments(flap) + osteotomies(flap) +
        element("p class=\"soft small\"",
                "Segments are in their order along the curve and along the donor, which gives " +
                    number(flap.at("donor_used_mm"), 1, " mm") +
                    ". Lengths are along the axis; sides are as far out as the bone may reach. Cuts are told "
                    "by their place along the donor's axis from its first point and their tilt from a square "
                    "cut. Contact: " +
                    name(flap.at("contact_estimator")) + ".");
  }
  return made;
}

}  // namespace octotomy::planner
