// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The page from top to bottom, a function a section: heading with the overall verdict, pictures with scale
// and mask outlines, measurements, certificates with their terms, scans with their audit, exports, plan,
// timings.
#include "planner/result/report/report_page.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "planner/operation/anatomy/head_directions.h"
#include "planner/operation/anatomy/measured_movement.h"
#include "planner/operation/measure/result_json.h"
#include "planner/operation/object/mask.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/table/number_format.h"
#include "planner/procedure/cephalometry/cephalometry_table.h"
#include "planner/result/report/airway_tables.h"
#include "planner/result/report/contact_report.h"
#include "planner/result/report/flap_tables.h"
#include "planner/result/report/html.h"
#include "planner/result/report/landmark_tables.h"
#include "planner/result/report/patient.h"
#include "planner/result/report/trial_tables.h"
#include "voxel/view/annotation.h"

namespace octotomy::planner {
namespace {

// ---- heading ----

std::string signatures(const Result& result) {
  std::string lines;
  for (const SignatureCheck& check : result.signatures)
    lines += element("p class=\"small\"",
                     pill(check.changed.empty() ? voxel::Verdict::Pass : voxel::Verdict::Warn) +
                         " signed by " + element("b", escaped(check.signature.by)) + ", " +
                         escaped(check.signature.as) + ", " + escaped(check.signature.at) +
                         (check.changed.empty() ? ", unchanged since" : ", changed since") +
                         (check.signature.note.empty() ? "" : ": " + escaped(check.signature.note)));
  return lines;
}

/// The patients of the report.
std::string patients(const Result& result) {
  std::string lines;
  if (result.anonymous) {
    lines = "left out as asked";
  } else {
    for (const std::string& line : patient_lines(result.evaluation))
      lines += (lines.empty() ? "" : "; ") + escaped(line);
  }
  return element("p class=\"patient\"", element("b", "Patient: ") + lines);
}

std::string heading(const Result& result) {
  std::string scans;
  for (const ScanRecord& scan : result.evaluation.scans)
    scans += (scans.empty() ? "" : ", ") +
             escaped(scan.made_by.empty() ? scan.path.generic_string() : scan.made_by);
  const std::string left =
      element("div", element("h1", escaped(result.plan.name)) + patients(result) +
                         element("p class=\"soft\"", "Scan " + scans + " \u00b7 Octotomy " OCTOTOMY_VERSION) +
                         signatures(result));
  return element("header", left + overall_verdict(verdict_counts(result.evaluation)));
}

std::string tiles(const std::vector<Measurement>& measurements) {
  std::string text;
  for (const Measurement& one : measurements)
    if (one.size)
      text += element("div", element("b", grouped(one.size->volume_mm3 / 1000.0, 2) + " cm\u00b3") +
                                 element("span", escaped(one.id) + " (" + escaped(one.size->object) + ")"));
  return text.empty() ? "" : element("div class=\"tiles\"", text);
}

// ---- pictures ----

/// Text over a picture; `size` is in the picture's pixels.
std::string svg_text(const glm::dvec2& at, double size, const std::string& anchor, const std::string& text) {
  return "<text x=\"" + fixed(at.x) + "\" y=\"" + fixed(at.y) + "\" text-anchor=\"" + anchor +
         "\" font-size=\"" + fixed(size) +
         "\" font-family=\"sans-serif\" fill=\"#44525a\" stroke=\"#fff\" stroke-width=\"" +
         fixed(size / 4.0) + "\" paint-order=\"stroke\">" + text + "</text>";
}

/// A scale bar of a round length in millimetres, at most a third of the picture.
std::string scale_bar(const ScenePicture& picture, double letters) {
  const double bar_mm = voxel::round_length(picture.width_mm / 3.0);
  const double size = picture.size_px;
  const std::string line =
      "M" + fixed(letters) + " " + fixed(size - letters) + "h" + fixed(bar_mm * size / picture.width_mm);
  return "<path d=\"" + line + "\" stroke=\"#fff\" stroke-width=\"" + fixed(letters / 2.6) +
         "\"/><path d=\"" + line + "\" stroke=\"#44525a\" stroke-width=\"" + fixed(letters / 6.5) + "\"/>" +
         svg_text({letters, size - 1.6 * letters}, letters, "start",
                  grouped(bar_mm, bar_mm < 1.0 ? 1 : 0) + " mm");
}

/// The outlines of the plan's mask regions that were drawn in this picture's view, in the head's orientation.
std::string outlines(const Plan& plan, const ScenePicture& picture, double size) {
  std::string paths;
  for (const Step& step : plan.steps)
    if (const auto* mask = step.action.get_if<Mask>())
      for (const Mask::Region& region : mask->regions) {
        if (region.view != picture.view || (mask->views_of == "scan" && plan.lps_from_head)) continue;
        for (const auto& polygon : region.polygons_mm) {
          paths +=
              "<path fill=\"#c8452f\" fill-opacity=\".07\" stroke=\"#c8452f\" stroke-width=\"1.5\" "
              "stroke-dasharray=\"6 4\" d=\"";
          char letter_of_path = 'M';
          for (const glm::dvec2& p_mm : polygon) {
            const glm::dvec2 p = (p_mm - picture.centre_mm) * (size / picture.width_mm);
            paths +=
                std::exchange(letter_of_path, 'L') + fixed(0.5 * size + p.x) + " " + fixed(0.5 * size - p.y);
          }
          paths += "Z\"/>";
        }
      }
  return paths;
}

std::string view_title(const ScenePicture& picture) {
  const auto comma = picture.view.find(',');
  if (comma == std::string::npos) return picture.view;
  const bool to_right = picture.view.starts_with('-');
  const std::size_t first = to_right ? 1 : 0;
  return picture.view.substr(first, comma - first) + "\u00b0 to the patient's " +
         (to_right ? "right" : "left") + ", " + picture.view.substr(comma + 1) + "\u00b0 above";
}

/// A picture's presentation on the page.
struct Placed {
  std::string title;
  std::string says;       ///< text before the view's name, for readers who cannot see the picture
  bool outlined = false;  ///< whether to draw the outlines of mask regions
  double letters = 13.0;  ///< in the picture's pixels
  std::vector<glm::dvec3> marks_mm = {};
};

std::string figure(const Plan& plan, const ScenePicture& picture, const Placed& placed) {
  const double size = picture.size_px, letters = placed.letters;
  std::string svg = "<svg viewBox=\"0 0 " + fixed(size) + " " + fixed(size) +
                    "\" role=\"img\" aria-label=\"" + escaped(placed.says + view_title(picture)) +
                    "\"><image width=\"" + fixed(size) + "\" height=\"" + fixed(size) +
                    "\" href=\"data:image/png;base64," + base64(picture.png) + "\"/>";
  if (placed.outlined) svg += outlines(plan, picture, size);
  svg += scale_bar(picture, letters);
  for (std::size_t i = 0; i < placed.marks_mm.size(); ++i) {
    const glm::dvec2 p =
        (picture.axes.project(placed.marks_mm[i]) - picture.centre_mm) * (size / picture.width_mm);
    const glm::dvec2 at(0.5 * size + p.x, 0.5 * size - p.y);
    svg += "<circle cx=\"" + fixed(at.x) + "\" cy=\"" + fixed(at.y) + "\" r=\"" + fixed(0.25 * letters) +
           "\" fill=\"none\" stroke=\"#222\"/>" +
           svg_text(at + glm::dvec2(0.4 * letters, -0.3 * letters), 0.9 * letters, "start",
                    std::to_string(i + 1));
  }
  svg += svg_text({0.6 * letters, 0.5 * size}, letters, "start", voxel::patient_side(-picture.axes.right));
  svg +=
      svg_text({size - 0.6 * letters, 0.5 * size}, letters, "end", voxel::patient_side(picture.axes.right));
  svg += svg_text({0.5 * size, 1.3 * letters}, letters, "middle", voxel::patient_side(picture.axes.up));
  svg +=
      svg_text({0.5 * size, size - 0.6 * letters}, letters, "middle", voxel::patient_side(-picture.axes.up));
  return element("figure", svg + "</svg>" + element("figcaption", placed.title));
}

/// "rest, maxilla".
std::string names_of(const PictureGroup& group) {
  std::string names;
  for (const voxel::DrawnObject& object : group.objects) names += (names.empty() ? "" : ", ") + object.name;
  return names;
}

std::string legend(const PictureGroup& group) {
  std::string items;
  for (const voxel::DrawnObject& object : group.objects)
    items += element(
        "span", "<i style=\"background:" + text_of_colour(object.colour) + "\"></i>" + escaped(object.name));
  return element("div class=\"legend\"", items);
}

/// A picture of a row of four is shown at half its size.
constexpr double small_letters = 24.0;

std::string group_section(const Result& result, const PictureGroup& group) {
  const bool two_in_a_row = group.most_mm > 0.0;
  std::string figures;
  for (const ScenePicture& picture : group.pictures) {
    Placed placed{view_title(picture), names_of(group) + ", "};
    if (!two_in_a_row) placed.letters = small_letters;
    placed.marks_mm = group.marks_mm;
    figures += figure(result.plan, picture, placed);
  }
  return element("h2", escaped(group.title)) + (two_in_a_row ? colour_scale(group.most_mm) : legend(group)) +
         element(two_in_a_row ? "div class=\"pictures two\"" : "div class=\"pictures four\"", figures);
}

/// Pictures of one view before and after are side by side; the others form a grid of views.
std::string pictures(const Result& result) {
  const auto named = [&](const std::string& name) {
    return std::find_if(result.pictures.begin(), result.pictures.end(),
                        [&](const PictureGroup& group) { return group.name == name; });
  };
  const auto before = named("before"), after = named("after");
  std::string html;
  if (before != result.pictures.end() && after != result.pictures.end()) {
    std::string pairs;
    for (const ScenePicture& picture : before->pictures)
      for (const ScenePicture& same : after->pictures)
        if (same.view == picture.view)
          pairs +=
              figure(result.plan, picture,
                     {"<b>Before</b>, " + view_title(picture), "before: " + names_of(*before) + ", ", true}) +
              figure(result.plan, same,
                     {"<b>After</b>, " + view_title(same), "after: " + names_of(*after) + ", "});
    html += element("h2", "Before and after") + legend(*after) + element("div class=\"pictures two\"", pairs);
  }
  for (const PictureGroup& group : result.pictures)
    if (group.name != "before" && !group.pictures.empty()) html += group_section(result, group);
  return html;
}

// ---- tables ----

std::string number_of(const std::optional<double>& value, int decimals) {
  return value ? grouped(*value, decimals) : "\u2013";
}
/// A number with its half-width.
std::string doubtful(const std::optional<double>& value, const std::optional<double>& half_width,
                     int decimals) {
  return number_of(value, decimals) + (half_width ? " \u00b1 " + three_figures(*half_width) : "");
}

/// A recommended number with its interval; a dash if the result has none.
std::string recommended(const std::optional<MeasuredInterval>& interval, int decimals) {
  return interval ? doubtful(interval->value, interval->half_width, decimals) : "\u2013";
}

std::string sizes(const std::vector<Measurement>& measurements) {
  std::string rows;
  for (const Measurement& one : measurements) {
    if (!one.size) continue;
    const MeasuredSize& size = *one.size;
    rows +=
        "<tr>" + cell(escaped(one.id)) + cell(escaped(size.object)) +
        figure_cell(element("b", recommended(size.volume, 1))) + figure_cell(number_of(size.volume_mm3, 1)) +
        figure_cell(size.mesh ? grouped(size.mesh->volume_mm3, 1) : "\u2013") +
        figure_cell(number_of(size.difference_mm3, 1)) + figure_cell(number_of(size.difference_percent, 2)) +
        figure_cell(element("b", recommended(size.area, 0))) +
        figure_cell(number_of(size.voxel.area_mm2, 0)) +
        figure_cell(size.mesh ? number_of(size.area_mm2, 0) : "\u2013") + "</tr>";
    if (size.finding) rows += "<tr><td colspan=\"10\">" + escaped(*size.finding) + "</td></tr>";
  }
  if (rows.empty()) return "";
  return element(
             "table",
             "<tr><th></th><th></th><th class=\"n group\" colspan=\"5\">Volume, mm\u00b3</th><th class=\"n "
             "group\" colspan=\"3\">Area, mm\u00b2</th></tr><tr><th>Measurement</th><th>Object</th><th "
             "class=\"n\">recommended</th><th class=\"n\">voxel kernel</th><th class=\"n\">mesh "
             "kernel</th><th "
             "class=\"n\">difference</th><th class=\"n\">%</th><th class=\"n\">recommended</th><th "
             "class=\"n\">Crofton 13</th><th "
             "class=\"n\">isosurface</th></tr>" +
                 rows) +
         element("p class=\"soft small\"",
                 "Recommended: one number by the scan's own samples; the true value lies within its \u00b1 "
                 "in 99 of 100 cases. Volume: voxels counted, and the mesh's enclosed volume by the "
                 "divergence theorem. "
                 "Area: "
                 "Crofton formula over 13 directions on voxels (up to 9 % low on flat cuts), and the "
                 "triangles of "
                 "the isosurface.");
}

std::string lengths(const std::vector<Measurement>& measurements) {
  std::string rows;
  for (const Measurement& one : measurements) {
    const std::string id = escaped(one.id);
    if (one.gap)
      rows += "<tr>" + cell(id) + cell("gap, " + escaped(one.gap->object) + " to " + escaped(one.gap->to)) +
              figure_cell(doubtful(one.gap->gap_mm, one.gap->gap_half_width_mm, 2) + " mm") +
              figure_cell(number_of(one.gap->gap_mesh_mm, 2) + " mm") +
              figure_cell(number_of(one.gap->overlap_mm3, 1) + " mm\u00b3") + "</tr>";
    if (one.distance)
      rows +=
          "<tr>" + cell(id) + cell("distance of two points") +
          figure_cell(doubtful(one.distance->distance_mm, one.distance->distance_half_width_mm, 2) + " mm") +
          cell("") + cell("") + "</tr>";
    if (one.angle)
      rows += "<tr>" + cell(id) + cell("angle at the second of three points") +
              figure_cell(doubtful(one.angle->angle_deg, one.angle->angle_half_width_deg, 2) + "\u00b0") +
              cell("") + cell("") + "</tr>";
  }
  if (rows.empty()) return "";
  return element("table",
                 "<tr><th>Measurement</th><th></th><th class=\"n\">voxel kernel</th><th class=\"n\">mesh "
                 "kernel</th><th class=\"n\">overlap</th></tr>" +
                     rows);
}

std::string measurements(const std::vector<Measurement>& all) {
  if (all.empty()) return "";
  return element("h2", "Measurements") + sizes(all) + lengths(all) + flap_tables(all) + contact_tables(all) +
         airway_tables(all) + landmark_tables(all) + trial_tables(all);
}

/// A displacement as cells, signed along the head's directions.
template <typename Displaced>
std::string displacement_cells(const Displaced& by) {
  const auto signed_mm = [](double mm) {
    return figure_cell((mm > 0.005 ? "+" : "") + grouped(std::abs(mm) < 0.005 ? 0.0 : mm, 2));
  };
  return signed_mm(by.forward_mm) + signed_mm(by.up_mm) + signed_mm(by.left_mm);
}

/// A row for each moved piece, for each landmark on it and for each point with a prescribed target.
std::string movements(const Result& result) {
  if (result.movements.empty()) return "";
  std::string rows =
      "<tr><th>Piece or point</th><th class=\"n\">forward, mm</th><th class=\"n\">up, mm</th><th "
      "class=\"n\">left, mm</th><th>In words</th></tr>";
  for (const Json& json : result.movements) {
    const auto moved = record_of<ObjectMovement>(json);
    rows += "<tr class=\"lead\">" + cell(element("b", escaped(moved.object))) +
            (moved.centroid ? displacement_cells(*moved.centroid) : cell("") + cell("") + cell("")) +
            cell(escaped(moved.words)) + "</tr>";
    for (const LandmarkMovement& landmark : moved.landmarks)
      rows += "<tr>" + cell(escaped(landmark.name)) + displacement_cells(landmark) +
              cell(escaped(landmark.words) +
                   (landmark.since_scan ? ", since the scan " + escaped(landmark.since_scan->words) : "")) +
              "</tr>";
    for (const PointMovement& point : moved.points)
      rows +=
          "<tr>" + cell(escaped(point.name) + ", wanted") + displacement_cells(point) +
          cell("wanted " + escaped(point.wanted) + ", came within " + grouped(point.residual_mm, 2) + " mm") +
          "</tr>";
  }
  return element("h2", "Movements") + element("table", rows) +
         element("p class=\"soft small\"", std::string(movement_words) +
                                               " A piece's own row is its centroid; landmarks are those "
                                               "that its bone is nearest to.");
}

/// A value with its interval, or a dash.
std::string interval_cell(const std::optional<CephalometricValue>& of, bool is_change) {
  if (!of) return figure_cell("\u2013");
  return figure_cell((is_change && of->value > 0.05 ? "+" : "") + grouped(of->value, 1) + " \u00b1 " +
                     grouped(of->half_width, 1));
}

std::string cephalometry(const Result& result) {
  if (result.cephalometry.is_null()) return "";
  const auto table = record_of<CephalometryTable>(result.cephalometry);
  std::string rows =
      "<tr><th>Measure</th><th></th><th class=\"n\">before</th><th class=\"n\">planned</th><th "
      "class=\"n\">change</th><th class=\"n\">norm</th></tr>";
  for (const CephalometryRow& row : table.measures)
    rows +=
        "<tr>" + cell(escaped(row.name) + ", " + (row.unit == "deg" ? "\u00b0" : row.unit)) +
        cell("<span class=\"soft\">" + escaped(row.says) + "</span>") + interval_cell(row.before, false) +
        interval_cell(row.after, false) + interval_cell(row.change, true) +
        figure_cell(row.norm ? grouped(*row.norm, 1) + " \u00b1 " + number_of(row.deviation, 1) : "\u2013") +
        "</tr>";
  const std::string picture =
      result.cephalogram.empty()
          ? ""
          : element(
                "figure",
                "<img alt=\"The radiograph from the right with landmarks and lines of the "
                "lateral measures\" src=\"data:image/png;base64," +
                    base64(result.cephalogram) + "\">" +
                    element("figcaption", "Radiograph in true scale; pale: the patient, orange: planned."));
  return element("h2", "Cephalometry") + element("div class=\"pictures two\"", picture) +
         element("table", rows) +
         element("p class=\"soft small\"",
                 "After each \u00b1, what landmarks placed to " + grouped(table.landmark_deviation_mm, 1) +
                     " mm (standard deviation along each axis) leave open in 99 of 100 cases; after each "
                     "norm, its standard deviation among people.");
}

std::string terms_of(const verify::Certificate& certificate, const std::string& definition) {
  std::string rows =
      "<tr><th>Source of difference that theory allows</th><th>Formula</th><th "
      "class=\"n\">mm\u00b3</th></tr>";
  for (const verify::ToleranceTerm& term : certificate.terms)
    rows += "<tr>" + cell(escaped(term.cause)) + cell(element("code", escaped(term.formula))) +
            figure_cell(three_figures(term.value_mm3)) + "</tr>";
  const std::string lineage =
      element("p class=\"small\"",
              "<span class=\"soft\">Voxel lineage:</span> " + escaped(certificate.voxel.lineage) +
                  ". <span class=\"soft\">Mesh lineage:</span> " + escaped(certificate.mesh.lineage) +
                  ". Tier " + escaped(verify::to_string(certificate.tier)) + ".");
  std::string limit;
  if (certificate.limit && certificate.limit->volume_mm3 > 0.0)
    limit =
        element("p class=\"small\"",
                "Detection limit: an error of more than " + three_figures(certificate.limit->volume_mm3) +
                    " mm\u00b3 in one place" +
                    (certificate.limit->shift_mm
                         ? ", or a shift of more than " + three_figures(*certificate.limit->shift_mm) + " mm,"
                         : "") +
                    " would have been seen.");
  const bool open = certificate.verdict == verify::Verdict::Fail;
  return std::string(open ? "<details open>" : "<details>") + "<summary>" +
         element("code", escaped(definition)) + "</summary>" + element("table", rows) + limit + lineage +
         "</details>";
}

std::string optional_mm(const std::optional<double>& value) {
  return value ? grouped(*value, 2) : "\u2013";
}

std::string certificates(const Result& result) {
  std::string rows =
      "<tr><th>Object</th><th>Verdict</th><th class=\"n\">voxel, mm\u00b3</th><th class=\"n\">mesh, "
      "mm\u00b3</th><th class=\"n\">difference / allowed, mm\u00b3</th><th class=\"n\">symmetric difference "
      "/ "
      "allowed, mm\u00b3</th><th class=\"n\">centroids / allowed, mm</th><th class=\"n\">Hausdorff 95, "
      "mm</th></tr>";
  bool any = false;
  for (const Object& object : result.evaluation.objects) {
    if (!object.certificate) {
      if (!object.findings.empty())
        rows += "<tr>" + element("td", element("b", escaped(object.id))) +
                element("td colspan=\"7\"", "no certificate" + list(object.findings)) + "</tr>";
      continue;
    }
    any = true;
    const verify::Certificate& c = *object.certificate;
    std::vector<std::string> notes = c.reasons;
    if (!c.resolved()) notes.push_back("not resolved: " + c.unresolved->reason);
    notes.insert(notes.end(), object.findings.begin(), object.findings.end());
    rows += "<tr class=\"lead\">" + cell(element("b", escaped(object.id))) +
            cell(pill(c.verdict, c.resolved())) + figure_cell(grouped(c.voxel.volume_mm3, 1)) +
            figure_cell(object.mesh.within ? grouped(c.mesh.volume_mm3, 1) : "\u2013") +
            figure_cell(grouped(c.difference_mm3, 1) + " / " + grouped(c.tolerance_mm3, 1) +
                        gauge(c.difference_mm3, c.tolerance_mm3, c.verdict)) +
            figure_cell(grouped(c.symmetric_difference_mm3, 0) + " / " +
                        grouped(c.symmetric_difference_tolerance_mm3, 0)) +
            figure_cell(optional_mm(c.centroid_distance_mm) + " / " + optional_mm(c.centroid_tolerance_mm)) +
            figure_cell(optional_mm(c.hausdorff95_mm)) + "</tr><tr class=\"terms\">" +
            element("td colspan=\"8\"", list(notes) + terms_of(c, object.definition)) + "</tr>";
  }
  if (!any) return "";
  return element("h2", "Certificates") +
         element("p class=\"soft\"",
                 "Each object with a mesh was made twice: by Booleans of octrees, and by corefinement of "
                 "meshes from the "
                 "scan's own samples. "
                 "The difference must stay within what voxel size and boundary allow, computed beforehand.") +
         element("table", rows) +
         element("p class=\"soft small\"",
                 "Symmetric difference: volume of the voxels that only one kernel holds. Hausdorff 95: the "
                 "larger of the two "
                 "directed 95th percentiles of distance between voxel faces and triangles.");
}

std::string parts_table(const Result& result) {
  if (result.parts.empty()) return "";
  constexpr std::size_t most_shown = 6;
  std::string rows =
      "<tr><th>Object</th><th class=\"n\">parts</th><th class=\"n\">volumes of the largest, "
      "mm\u00b3</th></tr>";
  for (const Parts& parts : result.parts) {
    std::string volumes;
    for (std::size_t i = 0; i < std::min(most_shown, parts.volumes_mm3.size()); ++i)
      volumes += (i == 0 ? "" : " \u00b7 ") + grouped(parts.volumes_mm3[i], 0);
    if (parts.volumes_mm3.size() > most_shown) volumes += " \u2026";
    rows += "<tr>" + cell(escaped(parts.object)) +
            figure_cell(grouped(static_cast<double>(parts.volumes_mm3.size()), 0)) + figure_cell(volumes) +
            "</tr>";
  }
  return element("h2", "Connected parts") + element("table", rows) +
         element("p class=\"soft small\"", "Voxels are connected where they share a face.");
}

std::string matrix_text(const glm::dvec3& v) {
  return grouped(v.x, 3) + " \u00d7 " + grouped(v.y, 3) + " \u00d7 " + grouped(v.z, 3) + " mm";
}

std::string scans(const Result& result) {
  std::string html = element("h2", "Scan and audit");
  for (const ScanRecord& scan : result.evaluation.scans) {
    const auto fact = [](const std::string& name, const std::string& value) {
      return element("dt", name) + element("dd", value);
    };
    const glm::ivec3 dims = scan.lattice.dims;
    const std::string unit = scan.unit == "1" ? " (no unit known)" : " " + escaped(scan.unit);
    html += element(
        "dl class=\"facts\"",
        fact("Scan",
             escaped(scan.name + ": " + (scan.made_by.empty() ? scan.path.generic_string() : scan.made_by))) +
            fact("Modality", scan.modality.empty() ? "not stated" : escaped(scan.modality)) +
            fact("Samples", std::to_string(dims.x) + " \u00d7 " + std::to_string(dims.y) + " \u00d7 " +
                                std::to_string(dims.z)) +
            fact("Spacing", matrix_text(scan.lattice.spacing_mm())) +
            fact("Range", grouped(scan.range.low, 0) + " to " + grouped(scan.range.high, 0) + unit) +
            fact("SHA-256", scan.made_by.empty() ? element("code title=\"" + scan.sha256 + "\"",
                                                           scan.sha256.substr(0, 16) + "\u2026")
                                                 : "made by a step of the plan"));
    std::string rows = "<tr><th>Check</th><th></th><th>Finding</th></tr>";
    for (const voxel::Finding& finding : scan.audit)
      rows += "<tr>" + cell(escaped(finding.check)) + cell(pill(finding.verdict)) +
              cell(escaped(finding.detail)) + "</tr>";
    if (!scan.audit.empty()) html += element("table", rows);
  }
  const voxel::Universe& universe = result.evaluation.universe;
  return html + element("p class=\"soft small\"", "Universe: " + std::to_string(universe.side()) +
                                                      "\u00b3 voxels of " +
                                                      matrix_text(universe.lattice().spacing_mm()) +
                                                      ". Coordinates are DICOM's LPS in millimetres.");
}

std::string findings(const Result& result) {
  if (result.findings.empty()) return "";
  std::string rows;
  for (const voxel::Finding& finding : result.findings)
    rows += "<tr>" + cell(escaped(finding.check)) + cell(pill(finding.verdict)) +
            cell(escaped(finding.detail)) + "</tr>";
  return element("h2", "Findings") + element("table", rows);
}

std::string exports(const Result& result) {
  if (result.exported.empty()) return "";
  std::string rows = "<tr><th>File</th><th>Object</th><th>Content</th><th class=\"n\">kB</th></tr>";
  for (const Exported& exported : result.exported) {
    const double kilobytes = exported.written ? exported.details.at("bytes").get<double>() / 1000.0 : 0.0;
    const std::string name =
        exported.written ? element("a href=\"" + escaped(exported.path) + "\"", escaped(exported.path))
                         : escaped(exported.path);
    rows +=
        "<tr>" + cell(name) + cell(escaped(exported.object)) +
        cell((exported.written ? exported.content : pill("warn", "NOT WRITTEN")) + list(exported.findings)) +
        figure_cell(exported.written ? grouped(kilobytes, 0) : "\u2013") + "</tr>";
  }
  return element("h2", "Exports") + element("table", rows);
}

std::string plan_text(const Result& result) {
  return element("h2", "Plan") +
         element("details", element("summary", plural(static_cast<int>(result.plan.steps.size()), "step") +
                                                   ", as JSON that <code>octotomy run</code> replays") +
                                element("pre", escaped(result.plan.text)));
}

std::string footer(const Result& result) {
  std::string times;
  for (const auto& [stage, milliseconds] : result.evaluation.timings)
    times += (times.empty() ? "" : " \u00b7 ") + stage + " " + grouped(milliseconds, 0) + " ms";
  return element("footer",
                 "Octotomy " OCTOTOMY_VERSION
                 ". A planning and research tool, not a medical device. Which checks support which "
                 "number: <a href=\"credibility.html\">credibility</a>. Times, some of them side by side: " +
                     times + ".");
}

}  // namespace

std::string report_html(const Result& result) {
  const std::vector<Measurement> measured = measurements_of(result.measurements);
  return html_page(result.plan.name, heading(result) + tiles(measured) + findings(result) + pictures(result) +
                                         movements(result) + cephalometry(result) + measurements(measured) +
                                         certificates(result) + parts_table(result) + scans(result) +
                                         exports(result) + plan_text(result) + footer(result));
}

}  // namespace octotomy::planner
