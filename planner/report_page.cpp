// SPDX-License-Identifier: AGPL-3.0-or-later
//
// The page from top to bottom, a function a section: heading with the overall verdict, pictures with scale
// and mask outlines, measurements, certificates with their terms, scans with their audit, exports, plan,
// timings.
#include "planner/report_page.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "planner/answer.h"
#include "planner/figures.h"
#include "voxel/annotation.h"

namespace octotomy::planner {
namespace {

constexpr std::string_view style = R"css(
:root{--ink:#1c2327;--soft:#5d6a72;--line:#d9dfe2;--wash:#f5f7f8;--accent:#1f5f7a;
--pass:#1d7a4c;--warn:#a56a00;--fail:#b3261e;--below:#50637a}
*{box-sizing:border-box}
body{margin:0;background:#fff;color:var(--ink);font:14px/1.5 "Inter","Segoe UI","Helvetica Neue",Helvetica,Arial,"DejaVu Sans",sans-serif;
-webkit-print-color-adjust:exact;print-color-adjust:exact}
main{max-width:1080px;margin:0 auto;padding:36px 32px 48px}
header{display:flex;gap:32px;justify-content:space-between;align-items:flex-start;border-bottom:2px solid var(--ink);padding-bottom:18px}
h1{font-size:27px;line-height:1.2;font-weight:600;letter-spacing:-.01em;margin:0 0 6px}
h2{font-size:13px;font-weight:600;letter-spacing:.07em;text-transform:uppercase;color:var(--accent);margin:34px 0 10px}
h3{font-size:14px;font-weight:600;margin:0 0 8px}
p{margin:0 0 8px}.soft{color:var(--soft)}.small{font-size:12px}
.verdict{min-width:250px;border-left:5px solid;padding:3px 0 3px 14px}.verdict b{display:block;font-size:17px}
.pass{border-color:var(--pass)}.warn{border-color:var(--warn)}.fail{border-color:var(--fail)}.below{border-color:var(--below)}
.pill{display:inline-block;padding:0 8px;border-radius:3px;color:#fff;font-size:11px;line-height:18px;font-weight:600;letter-spacing:.03em;white-space:nowrap}
.pill.pass{background:var(--pass)}.pill.warn{background:var(--warn)}.pill.fail{background:var(--fail)}.pill.below{background:var(--below)}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th{font-size:12px;font-weight:600;color:var(--soft);text-align:left;vertical-align:bottom;border-bottom:1px solid var(--ink);padding:4px 10px 4px 0}
td{border-bottom:1px solid var(--line);padding:5px 10px 5px 0;vertical-align:top}
th.n,td.n{text-align:right}td.n{white-space:nowrap}th:last-child,td:last-child{padding-right:0}
.group{border-bottom:1px solid var(--line);text-align:center}
code,pre{font:12px/1.5 "JetBrains Mono","SF Mono",Consolas,"DejaVu Sans Mono",monospace}
pre{background:var(--wash);padding:12px 14px;overflow:auto;white-space:pre-wrap;margin:8px 0 0}
.pictures{display:grid;gap:12px}.two{grid-template-columns:1fr 1fr}.four{grid-template-columns:repeat(4,1fr)}
figure{margin:0;break-inside:avoid}figure svg{display:block;width:100%;height:auto;border:1px solid var(--line);background:#fff}
figcaption{font-size:12px;color:var(--soft);padding-top:3px}figcaption b{color:var(--ink);font-weight:600}
.legend{display:flex;gap:18px;flex-wrap:wrap;margin:8px 0 12px;font-size:13px}.legend i{display:inline-block;width:12px;height:12px;border-radius:2px;margin-right:6px;vertical-align:-1px;border:1px solid rgba(0,0,0,.25)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:0;margin-top:18px;border-bottom:1px solid var(--line)}
.tiles div{padding:0 14px 12px 0}.tiles b{display:block;font-size:20px;font-weight:600;white-space:nowrap}.tiles span{font-size:12px;color:var(--soft)}
.gauge{display:inline-block;width:64px;height:7px;background:#e4e9eb;vertical-align:1px;margin-left:8px}.gauge i{display:block;height:7px;background:var(--pass)}
.gauge.warn i{background:var(--warn)}.gauge.fail i{background:var(--fail)}.gauge.below i{background:var(--below)}
details{margin:2px 0 6px}summary code{color:var(--ink)}summary{cursor:pointer;color:var(--accent);font-size:12px}
details table{margin:4px 0 8px;font-size:12px}
.findings{margin:6px 0 0;padding-left:18px}.findings li{margin-bottom:4px}
.facts{display:grid;grid-template-columns:repeat(4,auto);gap:2px 22px;font-size:13px;margin-bottom:12px;justify-content:start}.facts dt{color:var(--soft)}.facts dd{margin:0}
tr.terms td{padding-top:0;border-bottom:1px solid var(--line)}tr.lead td{border-bottom:0}
footer{margin-top:36px;padding-top:10px;border-top:1px solid var(--line);color:var(--soft);font-size:12px}
@media (max-width:760px){.two,.four{grid-template-columns:1fr 1fr}.facts{grid-template-columns:auto auto}header{flex-direction:column}main{padding:20px 16px}}
@media print{@page{size:A4;margin:14mm 12mm}body{font-size:11px}main{max-width:none;padding:0}h2{margin-top:20px;break-after:avoid}tr,figure,.verdict{break-inside:avoid}h1{font-size:21px}.tiles b{font-size:15px}pre{font-size:9px}}
)css";

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char symbol : text) {
    switch (symbol) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += symbol;
    }
  }
  return safe;
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = (three << 8) | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[(three >> (18 - 6 * k)) & 63] : '=';
  }
  return text;
}

std::string element(const std::string& tag, const std::string& inside) {
  return "<" + tag + ">" + inside + "</" + tag.substr(0, tag.find(' ')) + ">";
}

std::string cell(const std::string& text) {
  return element("td", text);
}
std::string figure_cell(const std::string& text) {
  return element("td class=\"n\"", text);
}

std::string fixed(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

std::string css_class(verify::Agreement agreement) {
  switch (agreement) {
    case verify::Agreement::Pass:
      return "pass";
    case verify::Agreement::Warn:
      return "warn";
    case verify::Agreement::Fail:
      return "fail";
    case verify::Agreement::BelowResolution:
      return "below";
  }
  return "fail";
}

std::string pill(const std::string& css, const std::string& text) {
  return element("span class=\"pill " + css + "\"", text);
}

std::string pill(verify::Agreement agreement) {
  std::string text = verify::to_string(agreement);
  std::replace(text.begin(), text.end(), '_', ' ');
  return pill(css_class(agreement), text);
}

std::string pill(voxel::Verdict verdict) {
  const char* css = verdict == voxel::Verdict::Pass   ? "pass"
                    : verdict == voxel::Verdict::Warn ? "warn"
                                                      : "fail";
  return pill(css, to_string(verdict));
}

std::string list(const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string items;
  for (const std::string& line : lines) items += element("li", escaped(line));
  return element("ul class=\"findings small\"", items);
}

std::string plural(int count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

// ---- heading ----

std::string overall_verdict(const Result& result) {
  const VerdictCounts counts = verdict_counts(result.evaluation);
  const int all = counts.pass + counts.warn + counts.fail + counts.below_resolution;
  if (all == 0) return "";
  const std::string css = counts.fail > 0   ? "fail"
                          : counts.warn > 0 ? "warn"
                          : counts.pass > 0 ? "pass"
                                            : "below";
  const std::string title = counts.fail > 0   ? "The two kernels disagree"
                            : counts.warn > 0 ? "The two kernels agree, with doubts"
                                              : "The two kernels agree";
  std::string lines = plural(all, "certificate") + ": " + std::to_string(counts.pass) + " pass";
  if (counts.warn > 0) lines += ", " + std::to_string(counts.warn) + " warn";
  if (counts.fail > 0) lines += ", " + std::to_string(counts.fail) + " fail";
  if (counts.below_resolution > 0)
    lines += ", " + std::to_string(counts.below_resolution) + " below resolution";
  return element("div class=\"verdict " + css + "\"",
                 element("b", title) + element("span class=\"soft\"", lines));
}

std::string heading(const Result& result) {
  std::string scans;
  for (const ScanRecord& scan : result.evaluation.scans)
    scans += (scans.empty() ? "" : ", ") + escaped(scan.path.generic_string());
  const std::string left =
      element("div", element("h1", escaped(result.plan.name)) +
                         element("p class=\"soft\"", "Scan " + scans + " \u00b7 Octotomy " OCTOTOMY_VERSION));
  return element("header", left + overall_verdict(result));
}

std::string tiles(const Result& result) {
  std::string text;
  for (const Measured& measured : result.evaluation.measured) {
    const Object& object = result.evaluation.objects[measured.object];
    text += element("div", element("b", grouped(object.voxel_measures.volume_mm3 / 1000.0, 2) + " cm\u00b3") +
                               element("span", escaped(measured.id) + " (" + escaped(object.id) + ")"));
  }
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

/// A bar of a round number of millimetres, at most a third of the picture.
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

/// The outlines of the plan's mask regions that were drawn in this picture's view.
std::string outlines(const Plan& plan, const ScenePicture& picture, double size) {
  std::string paths;
  for (const Step& step : plan.steps)
    if (const auto* mask = std::get_if<MaskStep>(&step.action))
      for (const RegionText& region : mask->regions) {
        if (region.view != picture.view) continue;
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

/// How a picture stands on the page.
struct Placed {
  std::string title;
  bool outlined = false;  ///< with the outlines of mask regions
  double letters = 13.0;  ///< in the picture's pixels
};

std::string figure(const Plan& plan, const ScenePicture& picture, const Placed& placed) {
  const double size = picture.size_px, letters = placed.letters;
  std::string svg = "<svg viewBox=\"0 0 " + fixed(size) + " " + fixed(size) +
                    "\" role=\"img\"><image width=\"" + fixed(size) + "\" height=\"" + fixed(size) +
                    "\" href=\"data:image/png;base64," + base64(picture.png) + "\"/>";
  if (placed.outlined) svg += outlines(plan, picture, size);
  svg += scale_bar(picture, letters);
  svg += svg_text({0.6 * letters, 0.5 * size}, letters, "start", voxel::patient_side(-picture.axes.right));
  svg +=
      svg_text({size - 0.6 * letters, 0.5 * size}, letters, "end", voxel::patient_side(picture.axes.right));
  svg += svg_text({0.5 * size, 1.3 * letters}, letters, "middle", voxel::patient_side(picture.axes.up));
  svg +=
      svg_text({0.5 * size, size - 0.6 * letters}, letters, "middle", voxel::patient_side(-picture.axes.up));
  return element("figure", svg + "</svg>" + element("figcaption", placed.title));
}

std::string colour_text(const glm::vec3& colour) {
  char text[16];
  const auto byte = [](float part) {
    return static_cast<int>(std::lround(255.0f * std::clamp(part, 0.0f, 1.0f)));
  };
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(colour.x), byte(colour.y), byte(colour.z));
  return text;
}

std::string legend(const PictureGroup& group) {
  std::string items;
  for (const voxel::Drawn& object : group.objects)
    items += element(
        "span", "<i style=\"background:" + colour_text(object.colour) + "\"></i>" + escaped(object.name));
  return element("div class=\"legend\"", items);
}

/// A picture of a row of four is shown at half its size.
constexpr double small_letters = 24.0;

std::string group_section(const Result& result, const PictureGroup& group) {
  std::string figures;
  for (const ScenePicture& picture : group.pictures)
    figures += figure(result.plan, picture, {view_title(picture), false, small_letters});
  return element("h2", escaped(group.title)) + legend(group) +
         element("div class=\"pictures four\"", figures);
}

/// Pictures of one view before and after stand side by side; what remains is a grid of views.
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
          pairs += figure(result.plan, picture, {"<b>Before</b>, " + view_title(picture), true}) +
                   figure(result.plan, same, {"<b>After</b>, " + view_title(same)});
    html += element("h2", "Before and after") + legend(*after) + element("div class=\"pictures two\"", pairs);
  }
  for (const PictureGroup& group : result.pictures)
    if (group.name != "before" && !group.pictures.empty()) html += group_section(result, group);
  return html;
}

// ---- tables ----

std::string measurements(const Result& result) {
  if (result.evaluation.measured.empty()) return "";
  std::string rows =
      "<tr><th></th><th></th><th class=\"n group\" colspan=\"4\">Volume, mm\u00b3</th><th class=\"n group\" "
      "colspan=\"2\">Area, mm\u00b2</th></tr><tr><th>Measurement</th><th>Object</th><th class=\"n\">voxel "
      "kernel</th><th class=\"n\">mesh kernel</th><th class=\"n\">difference</th><th class=\"n\">%</th>"
      "<th class=\"n\">Crofton 13</th><th class=\"n\">isosurface</th></tr>";
  for (const Measured& measured : result.evaluation.measured) {
    const Object& object = result.evaluation.objects[measured.object];
    const double voxels_mm3 = object.voxel_measures.volume_mm3;
    rows +=
        "<tr>" + cell(escaped(measured.id)) + cell(escaped(object.id)) + figure_cell(grouped(voxels_mm3, 1));
    if (object.mesh_measures) {
      const double mesh_mm3 = object.mesh_measures->volume_mm3;
      const double percent = mesh_mm3 == 0.0 ? 0.0 : 100.0 * (voxels_mm3 - mesh_mm3) / mesh_mm3;
      rows += figure_cell(grouped(mesh_mm3, 1)) + figure_cell(grouped(voxels_mm3 - mesh_mm3, 1)) +
              figure_cell(grouped(percent, 2));
    } else {
      rows += figure_cell("\u2013") + figure_cell("\u2013") + figure_cell("\u2013");
    }
    rows += figure_cell(grouped(object.voxel_measures.area_crofton13_mm2, 0)) +
            figure_cell(object.mesh_measures ? grouped(object.mesh_measures->area_mm2, 0) : "\u2013") +
            "</tr>";
  }
  return element("h2", "Measurements") + element("table", rows) +
         element("p class=\"soft small\"",
                 "Volume: voxels counted, and the mesh's enclosed volume by the divergence theorem. Area: "
                 "Crofton formula "
                 "over 13 directions on voxels (up to 9 % low on flat cuts), and the triangles of the "
                 "isosurface.");
}

std::string gauge(double value, double allowed, verify::Agreement agreement) {
  const double share = allowed > 0.0  ? std::clamp(std::abs(value) / allowed, 0.0, 1.0)
                       : value == 0.0 ? 0.0
                                      : 1.0;
  return "<span class=\"gauge " + css_class(agreement) + "\"><i style=\"width:" + fixed(100.0 * share) +
         "%\"></i></span>";
}

std::string terms_of(const verify::Certificate& certificate, const std::string& definition) {
  std::string rows =
      "<tr><th>Source of difference that theory allows</th><th>Formula</th><th "
      "class=\"n\">mm\u00b3</th></tr>";
  for (const verify::ToleranceTerm& term : certificate.terms)
    rows += "<tr>" + cell(escaped(term.name)) + cell(element("code", escaped(term.formula))) +
            figure_cell(three_figures(term.value_mm3)) + "</tr>";
  const std::string lineage =
      element("p class=\"small\"",
              "<span class=\"soft\">Voxel lineage:</span> " + escaped(certificate.voxel.lineage) +
                  ". <span class=\"soft\">Mesh lineage:</span> " + escaped(certificate.mesh.lineage) +
                  ". Tier " + escaped(verify::to_string(certificate.tier)) + ".");
  const bool open = certificate.agreement == verify::Agreement::Fail;
  return std::string(open ? "<details open>" : "<details>") + "<summary>" +
         element("code", escaped(definition)) + "</summary>" + element("table", rows) + lineage +
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
    notes.insert(notes.end(), object.findings.begin(), object.findings.end());
    rows += "<tr class=\"lead\">" + cell(element("b", escaped(object.id))) + cell(pill(c.agreement)) +
            figure_cell(grouped(c.voxel.volume_mm3, 1)) + figure_cell(grouped(c.mesh.volume_mm3, 1)) +
            figure_cell(grouped(c.difference_mm3, 1) + " / " + grouped(c.tolerance_mm3, 1) +
                        gauge(c.difference_mm3, c.tolerance_mm3, c.agreement)) +
            figure_cell(grouped(c.symmetric_difference_mm3, 0) + " / " +
                        grouped(c.symmetric_difference_tolerance_mm3, 0)) +
            figure_cell(optional_mm(c.centroid_distance_mm) + " / " + optional_mm(c.centroid_tolerance_mm)) +
            figure_cell(optional_mm(c.hausdorff95_mm)) + "</tr><tr class=\"terms\">" +
            element("td colspan=\"8\"", list(notes) + terms_of(c, object.definition)) + "</tr>";
  }
  if (!any) return "";
  return element("h2", "Certificates") +
         element("p class=\"soft\"",
                 "Each object was made twice: by Booleans of octrees, and by corefinement of meshes from the "
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
        fact("Scan", escaped(scan.name) + ": " + escaped(scan.path.generic_string())) +
            fact("Modality", scan.modality.empty() ? "not stated" : escaped(scan.modality)) +
            fact("Samples", std::to_string(dims.x) + " \u00d7 " + std::to_string(dims.y) + " \u00d7 " +
                                std::to_string(dims.z)) +
            fact("Spacing", matrix_text(scan.lattice.spacing_mm())) +
            fact("Range", grouped(scan.range.low, 0) + " to " + grouped(scan.range.high, 0) + unit) +
            fact("SHA-256",
                 element("code title=\"" + scan.sha256 + "\"", scan.sha256.substr(0, 16) + "\u2026")));
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
  return element("footer", "Octotomy " OCTOTOMY_VERSION
                           ". A planning and research tool, not a medical device. Times: " +
                               times + ".");
}

}  // namespace

std::string report_html(const Result& result) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width,initial-scale=1\"><title>" +
         escaped(result.plan.name) + " \u00b7 Octotomy</title><style>" + std::string(style) +
         "</style></head><body><main>" + heading(result) + tiles(result) + findings(result) +
         pictures(result) + measurements(result) + certificates(result) + parts_table(result) +
         scans(result) + exports(result) + plan_text(result) + footer(result) + "</main></body></html>\n";
}

}  // namespace octotomy::planner
