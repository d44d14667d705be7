// SPDX-License-Identifier: AGPL-3.0-or-later
#include "planner/result/report/html.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "planner/operation/measure/result_json.h"
#include "planner/operation/picture/colour.h"
#include "planner/operation/table/number_format.h"
#include "voxel/view/surface_scalar.h"

namespace octotomy::planner {
namespace {

constexpr std::string_view style = R"css(
:root{--ink:#1c2327;--soft:#5d6a72;--line:#d9dfe2;--wash:#f5f7f8;--accent:#1f5f7a;
--pass:#1d7a4c;--warn:#a56a00;--fail:#b3261e;--below:#50637a;--paper:#fff;--track:#e4e9eb;--second:#c97b2a}
@media screen and (prefers-color-scheme:dark){:root{color-scheme:dark;--ink:#e6ebee;--soft:#a3b0b8;--line:#38434a;--wash:#1f272c;
--accent:#7cc0de;--paper:#14191c;--track:#38434a;--second:#e0a25c}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:14px/1.5 "Inter","Segoe UI","Helvetica Neue",Helvetica,Arial,"DejaVu Sans",sans-serif;
-webkit-print-color-adjust:exact;print-color-adjust:exact}
main{max-width:1080px;margin:0 auto;padding:36px 32px 48px}
header{display:flex;gap:32px;justify-content:space-between;align-items:flex-start;border-bottom:2px solid var(--ink);padding-bottom:18px;margin-bottom:14px}
h1{font-size:27px;line-height:1.2;font-weight:600;letter-spacing:-.01em;margin:0 0 6px}
h2{font-size:13px;font-weight:600;letter-spacing:.07em;text-transform:uppercase;color:var(--accent);margin:34px 0 10px}
h3{font-size:14px;font-weight:600;margin:20px 0 8px}
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
img{max-width:100%;height:auto}
code,pre{font:12px/1.5 "JetBrains Mono","SF Mono",Consolas,"DejaVu Sans Mono",monospace}
pre{background:var(--wash);padding:12px 14px;overflow:auto;white-space:pre-wrap;margin:8px 0 0}
.pictures{display:grid;gap:12px}.two{grid-template-columns:1fr 1fr}.four{grid-template-columns:repeat(4,1fr)}
figure{margin:0;break-inside:avoid}figure svg{display:block;width:100%;height:auto;border:1px solid var(--line);background:#fff}
figcaption{font-size:12px;color:var(--soft);padding-top:3px}figcaption b{color:var(--ink);font-weight:600}
.legend{display:flex;gap:18px;flex-wrap:wrap;margin:8px 0 12px;font-size:13px}.legend i{display:inline-block;width:12px;height:12px;border-radius:2px;margin-right:6px;vertical-align:-1px;border:1px solid rgba(0,0,0,.25)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:0;margin-top:18px;border-bottom:1px solid var(--line)}
.tiles div{padding:0 14px 12px 0}.tiles b{display:block;font-size:20px;font-weight:600;white-space:nowrap}.tiles span{font-size:12px;color:var(--soft)}
.gauge{display:inline-block;width:64px;height:7px;background:var(--track);vertical-align:1px;margin-left:8px}.gauge i{display:block;height:7px;background:var(--pass)}
.gauge.warn i{background:var(--warn)}.gauge.fail i{background:var(--fail)}.gauge.below i{background:var(--below)}
details{margin:2px 0 6px}summary code{color:var(--ink)}summary{cursor:pointer;color:var(--accent);font-size:12px}
details table{margin:4px 0 8px;font-size:12px}
.findings{margin:6px 0 0;padding-left:18px}.findings li{margin-bottom:4px}
.facts{display:grid;grid-template-columns:repeat(4,auto);gap:2px 22px;font-size:13px;margin-bottom:12px;justify-content:start}.facts dt{color:var(--soft)}.facts dd{margin:0}
tr.terms td{padding-top:0;border-bottom:1px solid var(--line)}tr.lead td{border-bottom:0}
footer{margin-top:36px;padding-top:10px;border-top:1px solid var(--line);color:var(--soft);font-size:12px}
@media (max-width:760px){.two,.four{grid-template-columns:1fr 1fr}.facts{grid-template-columns:auto auto}header{flex-direction:column}main{padding:20px 16px}table{display:block;overflow-x:auto}}
@media (max-width:480px){.two{grid-template-columns:1fr}}
@media print{@page{size:A4;margin:14mm 12mm}body{font-size:11px}main{max-width:none;padding:0}h2{margin-top:20px;break-after:avoid}tr,figure,.verdict{break-inside:avoid}h1{font-size:21px}.tiles b{font-size:15px}pre{font-size:9px}}
)css";

}  // namespace

std::string html_page(const std::string& title, const std::string& body) {
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width,initial-scale=1\"><title>" +
         escaped(title) + " \u00b7 Octotomy</title><style>" + std::string(style) +
         "</style></head><body><main>" + body + "</main></body></html>\n";
}

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

std::string css_class(voxel::Verdict verdict) {
  return verdict == voxel::Verdict::Pass ? "pass" : verdict == voxel::Verdict::Warn ? "warn" : "fail";
}

std::string pill(const std::string& css, const std::string& text) {
  return element("span class=\"pill " + css + "\"", text);
}

std::string pill(voxel::Verdict verdict) {
  return pill(css_class(verdict), verify::to_string(verdict));
}

std::string pill(voxel::Verdict verdict, bool resolved) {
  if (resolved) return pill(verdict);
  const bool passes = verdict == voxel::Verdict::Pass;
  return pill(passes ? "below" : css_class(verdict), verify::to_string(verdict) + ", not resolved");
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

std::string gauge(double value, double allowed, voxel::Verdict verdict) {
  const double share = allowed > 0.0  ? std::clamp(std::abs(value) / allowed, 0.0, 1.0)
                       : value == 0.0 ? 0.0
                                      : 1.0;
  return "<span class=\"gauge " + css_class(verdict) + "\"><i style=\"width:" + fixed(100.0 * share) +
         "%\"></i></span>";
}

std::string overall_verdict(const VerdictCounts& counts) {
  const int all = counts.pass + counts.warn + counts.fail;
  if (all == 0) return "";
  const bool proves = counts.pass > counts.pass_not_resolved;
  const std::string css = counts.fail > 0 ? "fail" : counts.warn > 0 ? "warn" : proves ? "pass" : "below";
  const std::string title = counts.fail > 0   ? "The two kernels disagree"
                            : counts.warn > 0 ? "The two kernels agree, with doubts"
                            : proves          ? "The two kernels agree"
                                              : "The two kernels agree on objects that voxels do not resolve";
  std::string lines = plural(all, "certificate") + ": " + std::to_string(counts.pass) + " pass";
  if (counts.warn > 0) lines += ", " + std::to_string(counts.warn) + " warn";
  if (counts.fail > 0) lines += ", " + std::to_string(counts.fail) + " fail";
  if (counts.not_resolved > 0) lines += "; " + std::to_string(counts.not_resolved) + " not resolved";
  if (counts.without_certificate > 0)
    lines += "; " + plural(counts.without_certificate, "object") + " without a certificate";
  return element("div class=\"verdict " + css + "\"",
                 element("b", title) + element("span class=\"soft\"", lines));
}

std::string colour_scale(double most_mm) {
  std::string stops;
  constexpr int steps = 8;
  for (int i = 0; i <= steps; ++i)
    stops += (i == 0 ? "" : ",") + text_of_colour(voxel::diverging_colour(-1.0 + 2.0 * i / steps));
  return element("div class=\"legend\"",
                 three_figures(-most_mm) +
                     " mm, inside<span style=\"display:inline-block;width:220px;height:14px;"
                     "background:linear-gradient(90deg," +
                     stops + ")\"></span>outside, " + three_figures(most_mm) + " mm");
}

}  // namespace octotomy::planner
